// docs_test.cpp: the documentation as text: links and anchors lead somewhere, pictures are there and shown,
// sentences are short, README fits a page.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/docs/docs_pages.h"
#include "tests/docs/named_tests.h"
#include "tests/support/long_test.h"

namespace tangi::docs {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const Tree& pages() {
    static const Tree all = pages_of(TP_SOURCE_DIR);
    return all;
}

bool is_prose(const std::string& page) {
    return page.starts_with("docs/guide/") || page.starts_with("docs/theory/");
}

long lines_in(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

TEST(Docs, LinkToWhatIsThere) {
    ASSERT_GT(pages().size(), 20u);
    EXPECT_THAT(
        broken_links(pages(),
                     [](const std::string& path) { return fs::exists(fs::path(TP_SOURCE_DIR) / path); }),
        IsEmpty());
}

TEST(Docs, ShowAllTheirPictures) {
    Names pictures;
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(TP_SOURCE_DIR) / "docs"))
        if (const std::string kind = entry.path().extension().string();
            kind == ".png" || kind == ".jpg" || kind == ".svg")
            pictures.push_back(fs::relative(entry.path(), TP_SOURCE_DIR).generic_string());
    EXPECT_THAT(unused_pictures(pages(), pictures), IsEmpty());
}

TEST(Docs, AreInShortSentences) {
    int seen = 0;
    for (const auto& [page, text] : pages()) {
        if (!is_prose(page)) continue;
        ++seen;
        EXPECT_THAT(long_prose(page, text), IsEmpty());
    }
    EXPECT_GT(seen, 8);
}

TP_LONG TEST(Docs, NameTestsThatAreThere) {
    std::set<std::string> tests;
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(TP_SOURCE_DIR) / "tests"))
        if (entry.path().extension() == ".cpp") tests.merge(tests_in(text_of(entry.path())));
    ASSERT_GT(tests.size(), 1000u);
    EXPECT_THAT(missing_tests(pages(), tests), IsEmpty());
}

TEST(Docs, BeginWithAPage) { EXPECT_LE(lines_in(pages().at("README.md")), 100); }

// From the index every page is reached, so that none is a dead end that nobody finds.
TEST(Docs, AreReachedFromTheIndex) {
    std::set<std::string> reached;
    Names open = {"docs/README.md"};
    while (!open.empty()) {
        const std::string page = open.back();
        open.pop_back();
        if (!pages().contains(page) || !reached.insert(page).second) continue;
        for (const Link& link : links_of(pages().at(page)))
            if (!is_address(link.target)) open.push_back(path_of(page, link.target));
    }
    for (const auto& [page, text] : pages())
        EXPECT_TRUE(!page.starts_with("docs/") || reached.contains(page))
            << page << " is linked from nowhere";
}

// --- What breaks a rule is noticed.

Names broken(const Tree& tree) {
    return broken_links(tree, [](const std::string& path) { return path == "docs/images/there.png"; });
}

TEST(Docs, WithBrokenLinksAreNoticed) {
    const std::string other =
        "# Other\n\n## Some heading: twice (2)\n\n## Same\n\n## Same\n\n    # no heading\n";
    for (const char* link : {"[a](missing.md)", "see [a](../b.md) there", "[a](b.md#none)", "[a](#none)",
                             "![a](images/missing.png)", "| [a](missing.md) |", "- [a](missing.md)",
                             "## [a](missing.md)", "[a\nb](missing.md)", "[a](b.md#no-heading)",
                             "[a](b.md#same-2)", "[![a](images/there.png)](missing.md)"})
        EXPECT_EQ(broken({{"docs/a.md", link}, {"docs/b.md", other}}).size(), 1u) << link;
    for (const char* link : {"[a](b.md)", "[a](b.md#some-heading-twice-2)", "[a](b.md#same-1)",
                             "[a](images/there.png)", "[a](https://example.org/missing)", "`[a](missing.md)`",
                             "    [a](missing.md)", "```sh\n[a](missing.md)\n```",
                             "# Here we are\n\n[a](#here-we-are)", "# Ägypten – ΔE\n\n[a](#ägypten--δe)"})
        EXPECT_THAT(broken({{"docs/a.md", link}, {"docs/b.md", other}}), IsEmpty()) << link;
}

TEST(Docs, WithPicturesThatNobodyShowsAreNoticed) {
    EXPECT_THAT(unused_pictures({{"docs/a.md", "![a](images/used.png)"}},
                                {"docs/images/used.png", "docs/images/old.png"}),
                ElementsAre("docs/images/old.png is shown on no page"));
}

TEST(Docs, WithTestsThatAreNotThereAreNoticed) {
    const std::set<std::string> tests =
        tests_in("TEST(Suite, Finds) {}\nTEST_F(Suite,\n     FindsMore) {}\n");
    EXPECT_THAT(tests, ElementsAre("Suite.Finds", "Suite.FindsMore"));
    const auto missing = [&](const std::string& text) { return missing_tests({{"a.md", text}}, tests); };
    EXPECT_THAT(missing("`Suite.Finds`, `Suite.FindsM*` and Suite.FindsMore; IMG_1.CR2, read me.Please"),
                IsEmpty());
    EXPECT_THAT(missing("`Suite.FindsM`"), ElementsAre("a.md: Suite.FindsM is no test"));
    EXPECT_THAT(missing("`Suite.Loses*`"), ElementsAre("a.md: Suite.Loses is no test"));
    EXPECT_THAT(missing("`Other.Finds`"), ElementsAre("a.md: Other.Finds is no test"));
}

std::string words(int count) {
    std::string text;
    for (int i = 0; i < count; ++i) text += i == 0 ? "Word" : " word";
    return text;
}

TEST(Docs, WithLongSentencesAreNoticed) {
    const std::string shorts = "\n\nOne. Two. Three. Four. Five. Six.\n";
    EXPECT_THAT(long_prose("a", words(45) + "." + shorts), IsEmpty());
    EXPECT_THAT(long_prose("a", words(46) + "." + shorts), ElementsAre(HasSubstr("a sentence of 46 words")));
    EXPECT_THAT(long_prose("a", "- " + words(46) + "." + shorts),
                ElementsAre(HasSubstr("a sentence of 46 words")));
    EXPECT_THAT(long_prose("a", words(30) + "\n" + words(30) + ".\n" + shorts),
                ElementsAre(HasSubstr("a sentence of 60 words")));
    EXPECT_THAT(long_prose("a", words(21) + ". " + words(21) + "."),
                ElementsAre(HasSubstr("21 words a sentence")));
    EXPECT_THAT(long_prose("a", words(20) + ". " + words(20) + "."), IsEmpty());
}

TEST(Docs, WithLongParagraphsAreNoticed) {
    std::string text;
    for (int i = 0; i < 13; ++i) text += words(10) + ". ";
    EXPECT_THAT(long_prose("a", text), ElementsAre(HasSubstr("a paragraph of 130 words")));
    EXPECT_THAT(long_prose("a", text.substr(0, text.size() / 2) + "\n\n" + text.substr(text.size() / 2)),
                IsEmpty());
}

TEST(Docs, AreNotBlamedForWhatIsNoProse) {
    const std::string many = words(130);
    for (const std::string& text :
         {"| " + many + " |", "    " + many, "```sh\n" + many + "\n```", "```math\n" + many + "\n```",
          "$$\n" + many + "\n$$", "# " + many, "`" + many + "`", "![" + many + "](a.png)"})
        EXPECT_THAT(long_prose("a", text), IsEmpty()) << text.substr(0, 20);
}

// The rules about flags, on a program of two commands; those of ours are in tests/programs/cli/docs_test.cpp.
const Flags kProgram = {{"fit", {"--out", "--residual"}}, {"relight", {"--out", "--light"}}};

TEST(Docs, WithFlagsThatNoCommandHasAreNoticed) {
    for (const char* text :
         {"`--faithful`", "`fit --light`", "    tangipaint fit A --light 1",
          "```sh\nPATH=x tangipaint\n./build/tangipaint relight --residual\n```", "| `fit A --gloss=3` |"})
        EXPECT_EQ(unknown_flags("a", text, kProgram).size(), 1u) << text;
    for (const char* text :
         {"`--light`", "`fit --residual --out`", "--faithful", "`cmake --preset dev --target x`",
          "    script/test --sanitize", "`fit_tests --gtest_filter='A*'`", "    fit A  # not --light",
          "`tangipaint fit --help`"})
        EXPECT_THAT(unknown_flags("a", text, kProgram), IsEmpty()) << text;
}

TEST(Docs, WithFlagsThatAreNotDocumentedAreNoticed) {
    const std::string fit = "\n## fit\n\n| `--out` | `--light` is another's |\n| `--residual` | |\n";
    const std::string relight = "\n## relight\n\n| `--out` | |\n| `--light` | |\n";
    EXPECT_THAT(undocumented_flags("# Commands\n" + fit + relight, kProgram), IsEmpty());
    EXPECT_THAT(undocumented_flags("# Commands\n" + fit + "\n## relight\n\n| `--light` | |\n", kProgram),
                ElementsAre("relight lacks --out"));
    EXPECT_THAT(undocumented_flags("# Commands\n" + fit + relight + "| `--lamp` | |\n", kProgram),
                ElementsAre("relight lists --lamp, which it has not"));
    EXPECT_EQ(undocumented_flags("# Commands\n" + fit, kProgram).size(),
              3u);  // the section and both of its flags
}

TEST(Docs, OfHelpAreReadAsItIsPrinted) {
    const std::string help =
        "Usage: x\n\nOptions:\n  -h,--help                   Print --this\n  --out TEXT REQUIRED         see "
        "--light\n"
        "  --shadows,--no-shadows{false}\n                              with --residual\n";
    EXPECT_THAT(flags_of_help(help), ElementsAre("--no-shadows", "--out", "--shadows"));
    EXPECT_THAT(
        commands_of_help("A: b\n\nSubcommands:\n  fit                         fit --x\n  relight    show\n"),
        ElementsAre("fit", "relight"));
}

}  // namespace
}  // namespace tangi::docs
