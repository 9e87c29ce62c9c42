// archive_command.cpp: tangipaint archive FILES --out BAG, and --check BAG.
#include <fmt/format.h>

#include "cli/arguments.h"
#include "cli/command_list.h"
#include "surface/base/error.h"
#include "surface/file/atomic_folder.h"
#include "surface/publish/bagit.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

struct ArchiveArguments {
    std::vector<std::string> files;
    std::string out, title, organization;
    bool check = false;
};

nlohmann::json checked(const ArchiveArguments& a) {
    if (a.files.size() != 1) throw UsageError("--check: takes one bag");
    const BagReport report = check_bag(a.files.front(), console_progress());
    constexpr std::size_t most = 10;
    if (!report.faults.empty()) {
        std::vector<std::string> first(
            report.faults.begin(),
            report.faults.begin() + static_cast<long>(std::min(most, report.faults.size())));
        fail("{}: is not as it was packed, in {} place{}: {}", a.files.front(), report.faults.size(),
             report.faults.size() == 1 ? "" : "s", fmt::join(first, "; "));
    }
    return {{"bag", a.files.front()},
            {"checked", true},
            {"payload_files", report.files},
            {"payload_bytes", report.bytes}};
}

nlohmann::json packed(const ArchiveArguments& a) {
    if (a.out.empty()) throw UsageError("--out: is required, unless --check checks a bag");
    if (fs::exists(a.out))
        fail("--out {}: is there already; a bag is made once, so give another name", a.out);
    const fs::path out = fs::weakly_canonical(fs::absolute(a.out));
    for (const std::string& file : a.files) {
        const fs::path inside = out.lexically_relative(fs::weakly_canonical(file));
        if (!inside.empty() && inside.begin()->string() != "..")
            fail("--out {}: lies in {}, which is to be packed; choose a place beside it", a.out, file);
    }
    AtomicFolder folder(a.out, "files.json");
    BagReport report;
    told_of(folder.temporary(), a.out, [&] {
        report = fill_bag(folder.temporary(), {a.files.begin(), a.files.end()},
                          {{"Source-Organization", a.organization}, {"External-Description", a.title}},
                          console_progress());
    });
    folder.commit();
    return {{"bag", a.out}, {"payload_files", report.files}, {"payload_bytes", report.bytes}};
}

}  // namespace

Command archive_command() {
    return {
        "archive",
        "pack photographs, painting, treatment and report into a bag for an archive (BagIt), or check one",
        [](Flags& flags) {
            auto a = std::make_shared<ArchiveArguments>();
            flags.option("FILES", a->files, "files and folders to pack; with --check, the bag").required();
            flags.option("--out", a->out, "the bag, a folder that is not there yet");
            flags.flag("--check", a->check, "compare a bag's files with their SHA-256");
            flags.option("--title", a->title, "what is in the bag, in a line (External-Description)");
            flags.option("--organization", a->organization, "who packs it (Source-Organization)");
            return [a, typed = flags.typed()] {
                if (!a->check) return packed(*a);
                refuse_typed(typed(), {"--out", "--title", "--organization"}, "is of a bag that is made");
                return checked(*a);
            };
        }};
}

}  // namespace tangi
