// layers_test.cpp: the order of rooms, of this repository and of small houses in which one line is planted.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/architecture/room_rules.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

std::string text_of(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

Tree repository() {
    const fs::path root = TP_SOURCE_DIR;
    Tree tree;
    for (const auto& [module, rule] : kModules)
        for (const auto& entry : fs::recursive_directory_iterator(root / module)) {
            const std::string name = entry.path().filename().string();
            // What stands in for threads and disks in a browser is of no native room.
            if (entry.path().parent_path().string().find("/web/platform") != std::string::npos) continue;
            if (name.ends_with(".h") || name.ends_with(".cpp") || name == "CMakeLists.txt")
                tree[fs::relative(entry.path(), root).generic_string()] = text_of(entry.path());
        }
    return tree;
}

TEST(Layers, OfTheRoomsAreOne) {
    const Tree tree = repository();
    EXPECT_THAT(rooms_of(tree), SizeIs(testing::Gt(40u)));
    EXPECT_THAT(include_violations(tree), IsEmpty());
    EXPECT_THAT(link_violations(tree), IsEmpty());
    EXPECT_THAT(room_violations(tree), IsEmpty());
    EXPECT_THAT(type_violations(tree), IsEmpty());
}

// Dear ImGui's own fields drop a decimal comma: "120,5" would be 1205. Numbers are typed in number_field.h.
TEST(Layers, OfNumbersThatAreTypedIsOne) {
    for (const auto& [path, text] : repository()) {
        if (!path.starts_with("viewer/") || path == "viewer/panels/number_field.cpp") continue;
        for (const char* field :
             {"ImGui::InputFloat", "ImGui::InputDouble", "ImGui::InputInt", "ImGui::InputScalar",
              "ImGui::Slider", "ImGui::VSlider", "ImGui::Drag", "ImGui::Color"}) {
            for (auto at = text.find(field); at != std::string::npos; at = text.find(field, at + 1))
                EXPECT_TRUE(text.compare(at, 18, "ImGui::ColorButton") == 0 ||
                            text.compare(at, 19, "ImGui::ColorConvert") == 0)
                    << path << ": " << text.substr(at, 30);
        }
    }
}

// nlohmann's own reader and writer take seconds to compile in each room that calls them, know no limits, and
// throw at text that is no UTF-8.
TEST(Layers, OfTextThatIsJsonIsOne) {
    for (const auto& [path, text] : repository()) {
        if (!kModules.contains(module_of(path)) || path.starts_with("surface/base/json_")) continue;
        for (const char* call : {"json::parse(", "json::accept(", ".dump("})
            EXPECT_EQ(text.find(call), std::string::npos)
                << path << ": " << call << " has its place in surface/base/json_text.h and json_reading.h";
    }
}

TEST(Layers, OfEveryFolderWithSourcesHaveARule) {
    // Tests, benchmarks and targets of the fuzzer may use everything.
    for (const auto& entry : fs::directory_iterator(TP_SOURCE_DIR)) {
        const std::string name = entry.path().filename().string();
        if (!entry.is_directory() || name == "build" || name == "tests" || name == "bench" ||
            name == "fuzz" || name[0] == '.')
            continue;
        const bool has_sources =
            std::any_of(fs::recursive_directory_iterator(entry), fs::recursive_directory_iterator(),
                        [](const auto& file) {
                            return file.path().extension() == ".cpp" || file.path().extension() == ".h";
                        });
        EXPECT_TRUE(!has_sources || kModules.contains(name)) << name;
    }
}

// A small house, in which one line is planted.
Tree house() {
    return {{"surface/base/CMakeLists.txt", "tangi_room(HEADERS a.h PRIVATE TBB::tbb)"},
            {"surface/base/a.h", "#include <vector>\n"},
            {"surface/image/CMakeLists.txt",
             "# Pictures.\ntangi_room(HEADERS b.h SOURCES b.cpp LINK tangi::surface_base)"},
            {"surface/image/b.h", "#include \"surface/base/a.h\"\n"},
            {"surface/image/b.cpp", "#include \"surface/image/b.h\"\n"},
            {"capture/photo/CMakeLists.txt",
             "tangi_room(HEADERS c.h LINK tangi::surface_image PRIVATE OpenImageIO::OpenImageIO)"},
            {"capture/photo/c.h", "#include \"surface/base/a.h\"\n"},
            {"fit/pixel/CMakeLists.txt", "tangi_room(HEADERS d.h LINK tangi::capture_photo)"},
            {"fit/pixel/d.h", "#include \"capture/photo/c.h\"\n"},
            {"paint/canvas/CMakeLists.txt", "tangi_room(HEADERS e.h LINK tangi::surface_image)"},
            {"paint/canvas/e.h", "// #include \"fit/pixel/d.h\"\n"}};
}

TEST(Layers, OfASoundHouseAreNotBlamed) {
    const Tree tree = house();
    EXPECT_THAT(include_violations(tree), IsEmpty());
    EXPECT_THAT(link_violations(tree), IsEmpty());
    EXPECT_THAT(room_violations(tree), IsEmpty());
}

TEST(Layers, BrokenByAnIncludeAreNoticed) {
    const std::pair<const char*, const char*> planted[] = {
        {"surface/base/a.h", "#include \"surface/image/b.h\""},  // within a module, too
        {"surface/image/b.cpp", "#  include <fit/pixel/d.h>"},
        {"capture/photo/c.h", "\t#include \"fit/pixel/d.h\"  // why"},
        {"paint/canvas/e.h", "#include \"capture/photo/c.h\""},
        {"fit/pixel/d.h", "#include \"../pixel/d.h\""},
        {"fit/pixel/d.h", "#include \"fit/old/d.h\""},
        {"surface/base/a.h", "#include <ceres/jet.h>"},
        {"paint/canvas/e.h", "#include <ceres/ceres.h>"},
        {"surface/base/a.h", "#include <opencv2/core.hpp>"},
        {"surface/image/b.cpp", "#include <OpenImageIO/imageio.h>"},
        {"capture/photo/c.h", "#include <OpenImageIO/imageio.h>"},  // in a header
        {"fit/pixel/d.h", "#include <ImfHeader.h>"},
        {"paint/canvas/e.h", "#include <GLFW/glfw3.h>"},
        {"surface/base/a.h", "#include <tbb/parallel_for.h>"},
        {"fit/pixel/d.h", "#include <ceres/jet.h>"}};  // which it may, but does not link
    for (const auto& [path, line] : planted) {
        Tree tree = house();
        tree[path] += std::string(line) + "\n";
        EXPECT_THAT(include_violations(tree), ElementsAre(HasSubstr(path))) << path << ": " << line;
    }
}

TEST(Layers, BrokenByALinkAreNoticed) {
    const std::pair<const char*, const char*> planted[] = {
        {"paint/canvas", "tangi_room(HEADERS e.h LINK tangi::fit_pixel)"},
        {"paint/canvas",
         "tangi_room(HEADERS e.h\n    LINK tangi::surface_image  # fine\n    PRIVATE Ceres::ceres)"},
        {"surface/image",
         "tangi_room(HEADERS b.h SOURCES b.cpp LINK tangi::surface_base PRIVATE OpenSSL::Crypto)"},
        {"capture/photo", "tangi_room(HEADERS c.h LINK tangi::surface_image OpenImageIO::OpenImageIO)"}};
    for (const auto& [folder, cmake] : planted) {
        Tree tree = house();
        tree[std::string(folder) + "/CMakeLists.txt"] = cmake;
        EXPECT_THAT(link_violations(tree), testing::Contains(HasSubstr(folder))) << cmake;
    }
    Tree round = house();
    round["surface/base/CMakeLists.txt"] = "tangi_room(HEADERS a.h LINK tangi::surface_image)";
    EXPECT_THAT(link_violations(round), testing::Contains(HasSubstr("surface/base links itself")));
}

TEST(Layers, OfRoomsThatAreLeftOutOrTooLargeAreNoticed) {
    Tree tree = house();
    tree["fit/pixel/x.cpp"] = "";
    EXPECT_THAT(room_violations(tree), ElementsAre(HasSubstr("is in no list")));
    tree = house();
    tree["fit/x.h"] = "";
    EXPECT_THAT(room_violations(tree), ElementsAre("fit/x.h: fit is no room"));
    tree = house();
    std::string list = "tangi_room(HEADERS d.h";
    for (int i = 0; i < 20; ++i) {
        const std::string file = "d" + std::to_string(i) + ".h";
        tree["fit/pixel/" + file] = "";
        list += " " + file;
    }
    tree["fit/pixel/CMakeLists.txt"] = list + ")";
    EXPECT_THAT(room_violations(tree), ElementsAre("fit/pixel has 21 pairs of header and source"));
}

TEST(Layers, OfTypesThatShareANameAreNoticed) {
    Tree tree = house();
    tree["fit/pixel/d.h"] +=
        "namespace tangi {\nstruct Kind {\n};\nstruct Other;\n}\nnamespace tangi::d {\nstruct Mine "
        "{\n};\n}\n";
    tree["paint/canvas/e.h"] += "namespace tangi {\nclass Other final : A {\n};\nstruct Mine {\n};\n}\n";
    EXPECT_THAT(type_violations(tree), IsEmpty());
    tree["surface/image/b.h"] += "namespace tangi {\n\nenum class Kind { one };\n}\n";
    EXPECT_THAT(type_violations(tree),
                ElementsAre("surface/image/b.h: tangi::Kind is in fit/pixel/d.h, too"));
}

}  // namespace
}  // namespace tangi
