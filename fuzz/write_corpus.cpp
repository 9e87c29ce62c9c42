// write_corpus.cpp: a whole file of every kind into FOLDER/KIND/, from where the targets begin.
#include "tests/support/file_kinds.h"

int main(int argc, char** argv) {
    using namespace tangi;
    if (argc != 2) return 2;
    const TestDir dir;
    for (const FileKind& kind : file_kinds(dir)) {
        const std::filesystem::path folder = std::filesystem::path(argv[1]) / kind.name;
        std::filesystem::create_directories(folder);
        write_bytes(folder / ("whole" + std::filesystem::path(kind.name).extension().string()), kind.whole);
    }
    return 0;
}
