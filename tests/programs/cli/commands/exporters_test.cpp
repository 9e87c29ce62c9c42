// exporters_test.cpp: laws of the table of exporters: the command, the window and the documentation have the
// same ones, and each writes what its row says.
#include "cli/export/exporter.h"

#include <set>

#include "cli/export/export_painting.h"
#include "paint/files/canvas_file.h"
#include "surface/file/version.h"
#include "tests/docs/docs_pages.h"
#include "tests/programs/support/cli_program.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST(Exporters, HaveNamesOfTheirOwn) {
    std::set<std::string> names, in_menu;
    for (const Exporter& exporter : exporters()) {
        EXPECT_TRUE(names.insert(exporter.name).second) << exporter.name;
        EXPECT_TRUE(!*exporter.in_menu || in_menu.insert(exporter.in_menu).second) << exporter.in_menu;
        EXPECT_EQ(&exporter_named(exporter.name), &exporter);
        EXPECT_TRUE(!*exporter.extension || *exporter.extension == '.') << exporter.name;
    }
}

// The snapshot is a button of the window, of what is seen there.
TEST(Exporters, OfTheWindowAreThoseOfTheCommand) {
    const std::vector<ExportFormat> of_window = exports_of_window();
    std::size_t i = 0;
    for (const Exporter& exporter : exporters()) {
        if (exporter.name == std::string("snapshot")) continue;
        ASSERT_LT(i, of_window.size()) << exporter.name;
        EXPECT_STREQ(of_window[i].format, exporter.name);
        EXPECT_STREQ(of_window[i].ending, exporter.extension);
        EXPECT_STREQ(of_window[i++].name, exporter.in_menu);
    }
    EXPECT_EQ(i, of_window.size());
}

TEST(Exporters, AreDocumented) {
    const std::string help = tangipaint({"export", "--help"}).out;
    const std::string page = docs::pages_of(TP_SOURCE_DIR).at("docs/reference/export-formats.md");
    for (const Exporter& exporter : exporters()) {
        EXPECT_THAT(help, HasSubstr(exporter.name));
        EXPECT_THAT(page, HasSubstr(fmt::format("\n| `{}` | ", exporter.name)));
    }
}

// Which program a file is of, where others take it; a part of a painting's file is packed.
bool says_its_program(const fs::path& file) {
    const std::string name = file.filename().string(), extension = file.extension().string();
    if (extension == ".ptm" || extension == ".rti" || name == "info.json") return true;
    return bytes_of(file).find(program_name()) != std::string::npos;
}

TEST(Exporters, WriteWhatTheirRowsSay) {
    const TinyStack stack;
    const Canvas canvas = read_canvas(stack.truth());
    for (const Exporter& exporter : exporters()) {
        const bool is_picture = exporter.name == std::string("snapshot");
        const fs::path out =
            stack.out(std::string("of-") + exporter.name + exporter.extension + (is_picture ? ".png" : ""));
        const nlohmann::json result =
            export_canvas({.canvas = canvas, .file = stack.truth()}, exporter.name, out, {});
        const bool is_folder = !*exporter.extension || exporter.name == std::string("tiles");
        EXPECT_EQ(fs::is_directory(out), is_folder && !is_picture) << exporter.name;
        ASSERT_FALSE(result.at("files").empty()) << exporter.name;
        for (const std::string file : result.at("files")) {
            EXPECT_TRUE(fs::is_regular_file(file)) << file;
            EXPECT_TRUE(says_its_program(file)) << file;
        }
    }
}

// The window's own, saved or not: its painting's file has none.
TEST(Exporters, TakeTheAnnotationsOfTheWindowAlong) {
    const TinyStack stack;
    const Canvas canvas = read_canvas(stack.truth());
    const nlohmann::json annotations = nlohmann::json::array(
        {{{"type", "Annotation"}, {"id", "urn:a"}, {"bodyValue", "A loss"}, {"target", "p#xywh=1,2,3,4"}}});
    for (const auto& [format, file] : {std::pair("web", "index.html"), std::pair("iiif", "manifest.json"),
                                       std::pair("openlime", "index.html")}) {
        const fs::path out = stack.out(format);
        export_canvas({.canvas = canvas, .annotations = annotations, .file = stack.truth()}, format, out, {});
        EXPECT_THAT(bytes_of(out / file), HasSubstr("A loss")) << format;
    }
}

}  // namespace
}  // namespace tangi
