// strange_files_test.cpp: what the program says of files that strangers made: in its own words, in few of
// them, at once, and without asking for memory that the file cannot fill.
#include "tests/programs/support/cli_program.h"
#include "tests/support/capture/picture_metadata.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr long kMostMemory_kib = 500 * 1024;  // of which 150 MB are libraries

// libpng writes to stderr by itself.
TEST(CliStrangeFiles, WordsOfLibrariesAreNotShown) {
    const TinyStack stack;
    std::string bytes = bytes_of(stack.photo(2));
    const std::size_t pixels = bytes.find("IDAT");
    ASSERT_NE(pixels, std::string::npos);
    for (std::size_t i = 0; i < 40; ++i) bytes[pixels + 100 + i] = '\x55';
    write_bytes(stack.photo(2), bytes);
    const Finished run = tangipaint({"fit", stack.path(), "--out", stack.out("a.exr")});
    EXPECT_TRUE(
        ended(run, 0, {stack.name(2) + ": cannot be decoded", "its pixels are damaged; copy it again"}));
    EXPECT_THAT(run.err, AllOf(Not(HasSubstr("libpng")), Not(HasSubstr("PNG read error"))));
    // For who looks for a fault of a library.
    const Finished told = tangipaint({"fit", stack.path(), "--out", stack.out("b.exr")},
                                     {.environment = {{"TANGIPAINT_LIBRARY_WORDS", "1"}}});
    EXPECT_THAT(told.err, HasSubstr("libpng"));
}

TEST(CliStrangeFiles, ALensFileThatIsDamagedIsToldInOurWords) {
    const TinyStack stack;
    write_bytes(stack.out("a.xml"),
                "<?xml version=\"1.0\"?>\n<opencv_storage>\n<image_width>24</image_width>\n"
                "<camera_matrix>\n<rows>3</rows><data>90. 0. 12.\xff"
                "a></camera_matrix>");
    const Finished run =
        tangipaint({"calibrate", stack.path(), "--lens", stack.out("a.xml"), "--out", stack.out("a.lp")});
    EXPECT_TRUE(
        ended(run, 1, {"a.xml: line 5: a tag ends that did not begin", "a calibration file of OpenCV"}));
    EXPECT_THAT(run.err, Not(HasSubstr("ERROR")));
}

TEST(CliStrangeFiles, APhotographThatClaimsToBeLargeIsLeftOutAtOnce) {
    const TinyStack stack;
    std::string bytes = bytes_of(stack.photo(2));
    const std::string size = be32(65'535) + be32(65'535) + std::string("\x10\x02\0\0\0", 5);
    bytes.replace(16, size.size(), size);
    bytes.replace(16 + size.size(), 4, be32(crc32_of("IHDR" + size)));
    write_bytes(stack.photo(2), bytes);
    const Finished run =
        tangipaint({"fit", stack.path(), "--out", stack.out("a.exr")}, {.timeout = std::chrono::seconds(20)});
    EXPECT_TRUE(
        ended(run, 0, {stack.name(2), "it says that it has 65535 x 65535 pixels, which its", "rejected"}));
    EXPECT_LT(run.peak_kib, kMostMemory_kib);
}

// An attribute of 1.9 GB in a file of some kilobytes.
TEST(CliStrangeFiles, AnExrThatAsksForGigabytesGetsNone) {
    const TinyStack stack([](GeneratorOptions& o) { o.format = GeneratorFormat::exr; });
    using namespace std::string_literals;
    for (const fs::path& file : {fs::path(stack.photo(2)), fs::path(stack.truth())}) {
        std::string bytes = bytes_of(file);
        const std::string channels = "channels\0chlist\0"s;
        const std::size_t at = bytes.find(channels);
        ASSERT_NE(at, std::string::npos);
        bytes[at + channels.size()] = static_cast<char>(bytes[at + channels.size()] - 4);
        const std::string line = "lineOrder\0lineOrder\0"s;
        const std::size_t later = bytes.find(line, at);
        ASSERT_NE(later, std::string::npos);
        bytes.replace(later, line.size() + 4, "lineOrdes\0string\0\0\0\0\x70\0\0"s);
        write_bytes(file, bytes);
    }
    const Finished run = tangipaint({"fit", stack.path(), "--out", stack.out("a.exr")});
    EXPECT_TRUE(ended(run, 0, {stack.name(2), "is damaged", "rejected"}));
    EXPECT_LT(run.peak_kib, kMostMemory_kib);
    const Finished shown =
        tangipaint({"relight", stack.truth(), "--residual", "--light", "0,0,1", "--out", stack.out("a.png")});
    EXPECT_TRUE(ended(shown, 1, {"truth.exr: is damaged: its header makes no sense"}));
    EXPECT_LT(shown.peak_kib, kMostMemory_kib);
}

TEST(CliStrangeFiles, MessagesAreShortWhateverAFileHolds) {
    const TinyStack stack;
    std::string list = "[0";
    for (int i = 0; i < 20'000; ++i) list += ", 0";
    write_bytes(stack.out("b.json"), "{\"" + stack.name(0) + "\": [" + list + "]]}");
    const Finished long_entry =
        tangipaint({"fit", stack.path(), "--brackets", stack.out("b.json"), "--out", stack.out("a.exr")});
    EXPECT_TRUE(ended(long_entry, 1, {"b.json: '" + stack.name(0), "is neither a file name nor"}));
    EXPECT_LT(long_entry.err.size(), 500u);
    write_bytes(stack.out("b.json"),
                "{\"a\": " + std::string(140'000, '[') + std::string(140'000, ']') + "}");
    const Finished deep =
        tangipaint({"fit", stack.path(), "--brackets", stack.out("b.json"), "--out", stack.out("a.exr")});
    EXPECT_TRUE(ended(deep, 1, {"b.json: has lists and objects in each other, deeper than 64"}));
    // Names that nobody has, each as long as names may be.
    stack.change_lights([](std::vector<std::string>& lines) {
        for (int i = 0; i < 3; ++i)
            lines.push_back(fmt::format("{} 0 0 1", std::string(5000, static_cast<char>('a' + i))));
        lines[0] = std::to_string(lines.size() - 1);
    });
    const Finished names = tangipaint({"fit", stack.path(), "--out", stack.out("a.exr")});
    std::istringstream lines(names.err);
    for (std::string line; std::getline(lines, line);) EXPECT_LT(line.size(), 1700u);
    for (const auto& warning : names.json()["warnings"]) EXPECT_LT(warning.get<std::string>().size(), 1700u);
}

}  // namespace
}  // namespace tangi
