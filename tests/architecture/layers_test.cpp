// layers_test.cpp: the dependency order of DESIGN is kept by every #include and every CMake LINK list.
//
//   surface <- capture <- fit      surface <- paint <- viewer      surface, capture <- datasets everything <-
//   cli      paint <- retouch <- viewer; retouch has the folder paint/retouch
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;
using Tree = std::map<std::string, std::string>;  // path from the root -> text

struct ModuleRule {
    std::string name;
    Names may_use;  // other modules; not only directly, but all of them
};

enum class Where { anywhere, sources, file_sources };  // in x.h too; only in x.cpp; only in x_file.cpp

struct PackageRule {
    std::string name;
    Names includes;  // how its headers begin
    Names targets;   // how its CMake targets begin; only PRIVATE where headers may not include it
    Names modules;   // that may use it
    Where where;
};

// The rules, all of them.
const Names kBelowCli = {"surface", "capture", "fit", "paint", "retouch", "viewer", "datasets"};

const std::vector<ModuleRule> kModules = {
    {"surface", {}},
    {"capture", {"surface"}},
    {"fit", {"surface", "capture"}},
    {"paint", {"surface"}},
    {"viewer", {"surface", "paint", "retouch"}},
    {"datasets", {"surface", "capture"}},
    {"retouch", {"surface", "paint"}},
    {"cli", kBelowCli},
};

const std::vector<PackageRule> kPackages = {
    {"Ceres", {"ceres/"}, {"Ceres::", "ceres"}, {"capture", "fit", "retouch"}, Where::anywhere},
    {"OpenCV",
     {"opencv"},
     {"${OpenCV_LIBS}", "opencv_"},
     {"capture", "fit", "paint", "retouch", "viewer"},
     Where::anywhere},
    {"OpenImageIO", {"OpenImageIO/"}, {"OpenImageIO::"}, kBelowCli, Where::file_sources},
    {"OpenEXR",
     {"OpenEXR/", "Imf", "Iex", "Imath", "half.h"},
     {"OpenEXR::", "Imath::"},
     kBelowCli,
     Where::file_sources},
    {"libzip", {"zip.h"}, {"PkgConfig::libzip"}, {"paint"}, Where::file_sources},
    {"Pango and Cairo", {"cairo", "pango/"}, {"PkgConfig::pangocairo"}, {"retouch"}, Where::file_sources},
    {"lcms2", {"lcms2"}, {"${LCMS2_LIBRARY}"}, {"capture", "viewer"}, Where::sources},
    {"OpenSSL", {"openssl/"}, {"OpenSSL::"}, {"retouch"}, Where::sources},
    {"GLFW", {"GLFW/"}, {"glfw"}, {"viewer"}, Where::anywhere},
    {"OpenGL",
     {"GL/", "GLES", "EGL/", "glad/", "epoxy/"},
     {"OpenGL::", "GLEW::", "PkgConfig::epoxy"},
     {"viewer"},
     Where::anywhere},
    {"X11", {"X11/"}, {"X11::"}, {"viewer"}, Where::sources},
    {"ImGui",
     {"imgui", "backends/imgui"},
     {"imgui", "ImGui::", "PkgConfig::imgui"},
     {"viewer"},
     Where::anywhere},
    {"FFmpeg", {"libav"}, {"PkgConfig::ffmpeg"}, {"viewer"}, Where::file_sources},
    {"libdeflate", {"libdeflate.h"}, {"${DEFLATE_LIBRARY}"}, {"surface"}, Where::file_sources},
    {"fontconfig and FreeType", {"fontconfig/"}, {"PkgConfig::fonts"}, {"viewer"}, Where::sources},
    {"zlib", {"zlib.h"}, {"ZLIB::"}, {"viewer"}, Where::sources},
    {"TBB", {"tbb/", "oneapi/tbb"}, {"TBB::"}, kBelowCli, Where::sources},
    {"Highway", {"hwy/"}, {"${HWY_LIBRARY}"}, {"surface", "fit"}, Where::anywhere},
};

bool contains(const Names& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

bool begins_with_any(const std::string& text, const Names& beginnings) {
    return std::any_of(beginnings.begin(), beginnings.end(),
                       [&](const auto& b) { return text.starts_with(b); });
}

const ModuleRule* module_rule(const std::string& name) {
    const auto found =
        std::find_if(kModules.begin(), kModules.end(), [&](const auto& m) { return m.name == name; });
    return found == kModules.end() ? nullptr : &*found;
}

// Retouching is a module of its own in a folder of paint's.
std::string module_of(const std::string& path) {
    return path.starts_with("paint/retouch/") ? "retouch" : path.substr(0, path.find('/'));
}

// What a file includes, without the quotes or brackets.
Names includes_of(const std::string& text) {
    Names includes;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        const auto hash = line.find_first_not_of(" \t");
        if (hash == std::string::npos || line[hash] != '#') continue;
        const auto word = line.find_first_not_of(" \t", hash + 1);
        if (word == std::string::npos || line.compare(word, 7, "include") != 0) continue;
        const auto open = line.find_first_of("<\"", word);
        const auto close = open == std::string::npos ? open : line.find_first_of(">\"", open + 1);
        if (close != std::string::npos) includes.push_back(line.substr(open + 1, close - open - 1));
    }
    return includes;
}

bool allowed_place(const std::string& path, Where where) {
    if (where == Where::file_sources) return path.ends_with("_file.cpp");
    return where == Where::anywhere || path.ends_with(".cpp");
}

// One line for each #include that breaks a rule.
Names include_violations(const Tree& sources) {
    Names violations;
    for (const auto& [path, text] : sources) {
        const std::string module = module_of(path);
        for (const std::string& include : includes_of(text)) {
            const std::string other = module_of(include);
            if (include.find("../") != std::string::npos)
                violations.push_back(path + " includes " + include + ": give the path from the root");
            else if (module_rule(other) && other != module && !contains(module_rule(module)->may_use, other))
                violations.push_back(path + " includes " + include + ": " + module + " may not use " + other);
            for (const PackageRule& package : kPackages) {
                if (!begins_with_any(include, package.includes)) continue;
                if (!contains(package.modules, module))
                    violations.push_back(path + " includes " + include + ": " + module + " may not use " +
                                         package.name);
                else if (!allowed_place(path, package.where))
                    violations.push_back(path + " includes " + include + ": " + package.name +
                                         (package.where == Where::sources ? " belongs in .cpp files"
                                                                          : " belongs in *_file.cpp files"));
            }
        }
    }
    return violations;
}

// The lists of tangi_module(<name> HEADERS … SOURCES … LINK … PRIVATE …).
struct CMakeModule {
    std::string name;
    Names linked, linked_privately;
};

std::vector<CMakeModule> cmake_modules(const std::string& text) {
    std::string plain;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) plain += line.substr(0, line.find('#')) + '\n';
    std::vector<CMakeModule> modules;
    const std::string call = "tangi_module(";
    for (auto at = plain.find(call); at != std::string::npos; at = plain.find(call, at + 1)) {
        if (at > 0 && plain[at - 1] == '(') continue;  // function(tangi_module name)
        const auto begin = at + call.size();
        std::istringstream words(plain.substr(begin, plain.find(')', begin) - begin));
        CMakeModule module;
        words >> module.name;
        std::string list;
        for (std::string word; words >> word;) {
            if (word == "HEADERS" || word == "SOURCES" || word == "LINK" || word == "PRIVATE")
                list = word;
            else if (list == "LINK")
                module.linked.push_back(word);
            else if (list == "PRIVATE")
                module.linked_privately.push_back(word);
        }
        modules.push_back(module);
    }
    return modules;
}

// Modules that `name` links, and those that they link.
std::set<std::string> reachable(const std::string& name, const std::vector<CMakeModule>& modules) {
    std::set<std::string> found;
    for (const CMakeModule& module : modules) {
        if (module.name != name) continue;
        for (const Names* list : {&module.linked, &module.linked_privately})
            for (const std::string& target : *list)
                if (target.starts_with("tangi::") && found.insert(target.substr(7)).second)
                    found.merge(reachable(target.substr(7), modules));
    }
    return found;
}

// One line for each link that breaks a rule, and for each #include that no link covers.
Names link_violations(const std::string& cmake, const Tree& sources) {
    Names violations;
    const std::vector<CMakeModule> modules = cmake_modules(cmake);
    for (const CMakeModule& module : modules) {
        const ModuleRule* rule = module_rule(module.name);
        if (!rule) {
            violations.push_back("module " + module.name + " has no rule");
            continue;
        }
        Names all = module.linked;
        all.insert(all.end(), module.linked_privately.begin(), module.linked_privately.end());
        for (const std::string& target : all) {
            if (target.starts_with("tangi::") && !contains(rule->may_use, target.substr(7)))
                violations.push_back(module.name + " links " + target + ", which it may not use");
            for (const PackageRule& package : kPackages) {
                if (!begins_with_any(target, package.targets)) continue;
                if (!contains(package.modules, module.name))
                    violations.push_back(module.name + " links " + target + ": it may not use " +
                                         package.name);
                else if (package.where != Where::anywhere && contains(module.linked, target))
                    violations.push_back(module.name + " links " + target +
                                         " publicly: it belongs under PRIVATE");
            }
        }
        const std::set<std::string> linked = reachable(module.name, modules);
        for (const auto& [path, text] : sources) {
            if (module_of(path) != module.name) continue;
            for (const std::string& include : includes_of(text)) {
                const std::string other = module_of(include);
                if (module_rule(other) && other != module.name && !linked.contains(other))
                    violations.push_back(path + " includes " + include + ", but " + module.name +
                                         " does not link it");
                for (const PackageRule& package : kPackages)
                    if (begins_with_any(include, package.includes) &&
                        std::none_of(all.begin(), all.end(), [&](const auto& target) {
                            return begins_with_any(target, package.targets);
                        }))
                        violations.push_back(path + " includes " + include + ", but " + module.name +
                                             " does not link " + package.name);
            }
        }
    }
    return violations;
}

std::string text_of(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

Tree sources_of_the_repository() {
    const fs::path root = TP_SOURCE_DIR;
    Tree sources;
    for (const ModuleRule& module : kModules) {
        if (!fs::is_directory(root / module.name)) continue;
        for (const auto& entry : fs::recursive_directory_iterator(root / module.name)) {
            const std::string extension = entry.path().extension().string();
            if (extension == ".h" || extension == ".cpp")
                sources[fs::relative(entry.path(), root).generic_string()] = text_of(entry.path());
        }
    }
    return sources;
}

TEST(Layers, OfTheIncludesAreKept) {
    const Tree sources = sources_of_the_repository();
    ASSERT_GT(sources.size(), 40u);
    EXPECT_THAT(include_violations(sources), testing::IsEmpty());
}

// Dear ImGui's own fields drop a decimal comma: "120,5" would be 1205. Numbers are typed in number_field.h.
TEST(Layers, OfNumbersThatAreTypedIsOne) {
    for (const auto& [path, text] : sources_of_the_repository()) {
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

TEST(Layers, OfTheLinkListsAreKept) {
    const std::string cmake = text_of(fs::path(TP_SOURCE_DIR) / "CMakeLists.txt");
    Names found;
    for (const CMakeModule& module : cmake_modules(cmake)) found.push_back(module.name);
    EXPECT_THAT(found, testing::IsSupersetOf({"surface", "capture", "fit"}));
    EXPECT_THAT(link_violations(cmake, sources_of_the_repository()), testing::IsEmpty());
}

TEST(Layers, OfEveryFolderWithSourcesHaveARule) {
    // Tests, benchmarks and targets of the fuzzer may use everything.
    for (const auto& entry : fs::directory_iterator(TP_SOURCE_DIR)) {
        const std::string name = entry.path().filename().string();
        if (!entry.is_directory() || name == "build" || name == "tests" || name == "bench" ||
            name == "fuzz" || name[0] == '.')
            continue;
        const bool has_sources =
            std::any_of(fs::directory_iterator(entry), fs::directory_iterator(), [](const auto& file) {
                return file.path().extension() == ".cpp" || file.path().extension() == ".h";
            });
        EXPECT_TRUE(!has_sources || module_rule(name)) << name;
    }
}

TEST(Layers, BrokenByAnIncludeAreNoticed) {
    const std::pair<const char*, const char*> planted[] = {
        {"surface/x.cpp", "#include \"capture/stack.h\""},
        {"surface/x.h", "#  include <fit/ward_fit.h>"},
        {"capture/x.cpp", "\t#include \"fit/height.h\"  // why"},
        {"fit/x.h", "#include \"paint/brush.h\""},
        {"paint/x.cpp", "#include \"capture/stack.h\""},
        {"paint/x.cpp", "#include \"viewer/window.h\""},
        {"paint/x.cpp", "#include \"paint/retouch/mask.h\""},
        {"paint/retouch/x.cpp", "#include \"fit/height.h\""},
        {"paint/retouch/x.h", "#include <openssl/evp.h>"},
        {"datasets/x.cpp", "#include \"fit/height.h\""},
        {"viewer/x.cpp", "#include \"fit/height.h\""},
        {"capture/x.cpp", "#include \"cli/main.h\""},
        {"fit/x.cpp", "#include \"../paint/brush.h\""},
        {"surface/x.cpp", "#include <ceres/jet.h>"},
        {"paint/x.cpp", "#include <ceres/ceres.h>"},
        {"surface/x.cpp", "#include <opencv2/core.hpp>"},
        {"fit/x.cpp", "#include <lcms2.h>"},
        {"capture/x.h", "#include <lcms2.h>"},
        {"datasets/x.cpp", "#include <opencv2/core.hpp>"},
        {"surface/x.cpp", "#include <OpenImageIO/imageio.h>"},
        {"surface/x_file.h", "#include <OpenImageIO/imageio.h>"},
        {"fit/x.cpp", "#include <ImfHeader.h>"},
        {"cli/x_file.cpp", "#include <OpenEXR/ImfHeader.h>"},
        {"paint/x.cpp", "#include <GLFW/glfw3.h>"},
        {"cli/x.cpp", "#include <GL/gl.h>"},
        {"cli/x.cpp", "#include \"imgui.h\""},
        {"surface/x.h", "#include <tbb/parallel_for.h>"},
        {"cli/x.cpp", "#include <oneapi/tbb/info.h>"},
        {"fit/x.h", "#include <oneapi/tbb.h>"}};
    for (const auto& [path, line] : planted) {
        const Tree sources = {{path, std::string("// x\n#pragma once\n") + line + "\n#include <vector>\n"}};
        EXPECT_EQ(include_violations(sources).size(), 1u) << path << ": " << line;
    }
}

TEST(Layers, KeptByAnIncludeAreNotBlamed) {
    const std::pair<const char*, const char*> fine[] = {
        {"capture/x.h", "#include \"surface/image.h\""},
        {"surface/x.h", "#include \"surface/image.h\""},
        {"fit/x.h", "#include \"capture/stack.h\""},
        {"paint/retouch/x.h", "#include \"paint/canvas.h\""},
        {"viewer/x.cpp", "#include <GLFW/glfw3.h>"},
        {"cli/x.cpp", "#include \"viewer/window.h\""},
        {"fit/x.cpp", "#include <oneapi/tbb/parallel_for.h>"},
        {"capture/x_file.cpp", "#include <OpenImageIO/imageio.h>"},
        {"paint/x.h", "// #include \"fit/height.h\""},
        {"surface/x.cpp", "const char* text = \"#include <ceres/jet.h>\";"}};
    for (const auto& [path, line] : fine)
        EXPECT_THAT(include_violations({{path, line}}), testing::IsEmpty()) << path << ": " << line;
}

TEST(Layers, BrokenByALinkAreNoticed) {
    const char* planted[] = {"tangi_module(surface HEADERS a.h LINK tangi::capture)",
                             "tangi_module(fit LINK tangi::capture PRIVATE tangi::paint)",
                             "tangi_module(paint\n    LINK tangi::surface  # fine\n    PRIVATE Ceres::ceres)",
                             "tangi_module(surface LINK glm::glm PRIVATE ${OpenCV_LIBS})",
                             "tangi_module(capture LINK tangi::surface OpenImageIO::OpenImageIO)",
                             "tangi_module(fit LINK tangi::capture TBB::tbb)",
                             "tangi_module(paint LINK tangi::surface PRIVATE glfw)",
                             "tangi_module(datasets LINK tangi::fit)",
                             "tangi_module(gadgets LINK tangi::surface)"};
    for (const char* cmake : planted) EXPECT_EQ(link_violations(cmake, {}).size(), 1u) << cmake;
}

TEST(Layers, OfIncludesThatNoLinkCoversAreNoticed) {
    const std::string cmake =
        "tangi_module(surface LINK glm::glm)\ntangi_module(capture LINK tangi::surface)\n"
        "tangi_module(fit LINK tangi::capture PRIVATE TBB::tbb)\n";
    EXPECT_THAT(
        link_violations(cmake, {{"fit/x.cpp", "#include \"surface/image.h\"\n#include <tbb/info.h>\n"}}),
        testing::IsEmpty());
    EXPECT_THAT(link_violations(cmake, {{"capture/x.cpp", "#include <tbb/info.h>\n"}}),
                testing::ElementsAre("capture/x.cpp includes tbb/info.h, but capture does not link TBB"));
    EXPECT_THAT(link_violations("tangi_module(capture LINK fmt::fmt)",
                                {{"capture/x.h", "#include \"surface/light.h\""}}),
                testing::ElementsAre("capture/x.h includes surface/light.h, but capture does not link it"));
}

}  // namespace
