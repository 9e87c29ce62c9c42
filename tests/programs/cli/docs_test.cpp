// docs_test.cpp: every flag of the program is documented, and every documented flag is one of the
// program's.
#include "tests/docs/docs_pages.h"
#include "tests/programs/support/cli_program.h"

namespace tangi {
namespace {

using testing::IsEmpty;

docs::Flags flags_of_the_program() {
    docs::Flags flags;
    for (const std::string& command : docs::commands_of_help(tangipaint({"--help"}).out))
        flags[command] = docs::flags_of_help(tangipaint({command, "--help"}).out);
    return flags;
}

TEST(CliDocs, ListEveryFlagAndNoOther) {
    const docs::Flags flags = flags_of_the_program();
    ASSERT_GT(flags.size(), 15u);
    ASSERT_TRUE(flags.at("fit").contains("--mm-per-pixel"));
    const docs::Tree pages = docs::pages_of(TP_SOURCE_DIR);
    EXPECT_THAT(docs::undocumented_flags(pages.at("docs/reference/commands.md"), flags), IsEmpty())
        << "script/commands-page writes docs/reference/commands.md anew";
}

TEST(CliDocs, HaveThePageOfCommandsThatTheProgramWrites) {
    const Finished check = Program({"--check"}, {.environment = {{"TANGIPAINT", TP_PROGRAM}}},
                                   TP_SOURCE_DIR "/script/commands-page")
                               .wait();
    EXPECT_EQ(check.code, 0) << check.err;
}

// A command is found by the name of its source.
TEST(CliDocs, HaveASourceForEveryCommand) {
    std::set<std::string> sources;
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(std::filesystem::path(TP_SOURCE_DIR) / "cli"))
        sources.insert(entry.path().filename().string());
    for (const std::string& command : docs::commands_of_help(tangipaint({"--help"}).out))
        EXPECT_TRUE(command == "help" || sources.contains(command + "_command.cpp")) << command;
}

TEST(CliDocs, UseNoFlagThatIsNotThere) {
    const docs::Flags flags = flags_of_the_program();
    ASSERT_GT(flags.size(), 15u);
    for (auto [page, text] : docs::pages_of(TP_SOURCE_DIR)) {
        const std::string old = docs::section_of(text, "Old names");
        if (!old.empty()) text.erase(text.find(old), old.size());
        EXPECT_THAT(docs::unknown_flags(page, text, flags), IsEmpty());
    }
}

}  // namespace
}  // namespace tangi
