// reader_target.cpp: one kind of file (TP_KIND, by its name in tests/file_kinds.h) as libFuzzer makes it: it
// is read, or there is an Error. Anything else that is thrown ends the target, as what the sanitizers find
// does.
#include <cstdio>
#include <cstdlib>

#include "tests/file_kinds.h"

namespace {

using namespace tangi;

struct Desk {
    TestDir dir;
    FileKind kind;
    std::filesystem::path file;

    Desk() {
        for (FileKind& one : file_kinds(dir))
            if (one.name == TP_KIND) kind = std::move(one);
        if (kind.name.empty()) std::abort();
        std::filesystem::create_directories(dir / "fuzzed");
        file = dir / "fuzzed" / kind.name;
    }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const Desk* const desk = new Desk;  // libFuzzer leaves by _exit()
    write_bytes(desk->file, std::string(reinterpret_cast<const char*>(data), size));
    try {
        desk->kind.read(desk->file);
    } catch (const Error&) {
    }
    return 0;
}
