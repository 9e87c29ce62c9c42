// reader_target.cpp: a kind of file, by its name in tests/support/file_kinds.h (TP_FUZZ_KIND in the
// environment), as libFuzzer makes it: it is read, or there is an Error. Anything else that is thrown ends
// the target, as what the sanitizers find does.
#include <cstdio>
#include <cstdlib>

#include "tests/support/file_kinds.h"

namespace {

using namespace tangi;

struct DocumentController {
    TestDir dir;
    FileKind kind;
    std::filesystem::path file;

    DocumentController() {
        const char* name = std::getenv("TP_FUZZ_KIND");
        for (FileKind& one : file_kinds(dir))
            if (name && one.name == name) kind = std::move(one);
        if (kind.name.empty()) {
            std::fprintf(stderr, "TP_FUZZ_KIND: set it to the name of a folder in fuzz/corpus\n");
            std::exit(2);
        }
        std::filesystem::create_directories(dir / "fuzzed");
        file = dir / "fuzzed" / kind.name;
    }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const DocumentController* const controller =
        new DocumentController;  // libFuzzer leaves by _exit()
    write_bytes(controller->file, std::string(reinterpret_cast<const char*>(data), size));
    try {
        controller->kind.read(controller->file);
    } catch (const Error&) {
    }
    return 0;
}
