// room_rules.h: rooms use each other in one order, and packages only where they belong; what breaks that,
// from every #include and every link list.
//
// A room is a folder with a CMakeLists.txt that calls tangi_room(); which rooms it may use is what its link
// list reaches. Modules, the top-level folders, may use others as kModules says.
#pragma once

#include <algorithm>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace tangi {

using Names = std::vector<std::string>;
using Tree = std::map<std::string, std::string>;  // path from the root -> text

inline const std::map<std::string, Names> kModules = {
    {"surface", {}},
    {"capture", {"surface"}},
    {"datasets", {"surface", "capture"}},
    {"fit", {"surface", "capture"}},
    {"paint", {"surface"}},
    {"retouch", {"surface", "paint"}},
    {"viewer", {"surface", "paint", "retouch"}},
    {"web", {"surface", "paint", "retouch", "viewer"}},
    {"cli", {"surface", "capture", "fit", "paint", "retouch", "viewer", "datasets"}},
    {"python", {"surface", "capture", "fit", "paint", "retouch", "datasets"}},
};

struct PackageRule {
    std::string name;
    Names includes;           // how its headers begin
    Names targets;            // how its CMake targets begin
    Names places;             // modules and rooms that may use it
    bool in_headers = false;  // elsewhere it stays inside the sources, and its target under PRIVATE
};

inline const std::vector<PackageRule> kPackages = {
    {"Ceres", {"ceres/"}, {"Ceres::"}, {"capture", "fit", "retouch"}, true},
    {"OpenCV",
     {"opencv"},
     {"opencv_"},
     {"surface/image", "surface/report", "capture", "fit", "paint", "retouch", "viewer"},
     true},
    {"OpenImageIO",
     {"OpenImageIO/"},
     {"OpenImageIO::"},
     {"surface/image_file", "surface/report", "capture/photo"}},
    {"OpenEXR",
     {"OpenEXR/", "Imf", "Iex", "Imath", "half.h"},
     {"OpenEXR::", "Imath::"},
     {"surface/painting_file"}},
    {"libzip", {"zip.h"}, {"PkgConfig::libzip"}, {"paint/files"}},
    {"Pango and Cairo", {"cairo", "pango/"}, {"PkgConfig::pangocairo"}, {"retouch/report"}},
    {"lcms2", {"lcms2"}, {"${LCMS2_LIBRARY}"}, {"capture", "viewer/render"}},
    {"OpenSSL", {"openssl/"}, {"OpenSSL::"}, {"surface/file"}},
    {"GLFW", {"GLFW/"}, {"glfw"}, {"viewer"}, true},
    {"OpenGL",
     {"GL/", "GLES", "EGL/", "glad/", "epoxy/"},
     {"OpenGL::", "GLEW::", "PkgConfig::epoxy"},
     {"viewer"},
     true},
    {"X11", {"X11/"}, {"X11::"}, {"viewer"}},
    {"ImGui", {"imgui", "backends/imgui"}, {"imgui", "ImGui::", "PkgConfig::imgui"}, {"viewer"}, true},
    {"FFmpeg", {"libav"}, {"PkgConfig::ffmpeg"}, {"viewer/video"}},
    {"libdeflate", {"libdeflate.h"}, {"${DEFLATE_LIBRARY}"}, {"surface/file", "surface/painting_file"}},
    {"fontconfig and FreeType", {"fontconfig/"}, {"PkgConfig::fonts"}, {"viewer/panels"}},
    {"zlib", {"zlib.h"}, {"ZLIB::"}, {"viewer/web"}},
    {"utf8proc", {"utf8proc"}, {"PkgConfig::utf8proc"}, {"capture"}},
    {"TBB", {"tbb/", "oneapi/tbb"}, {"TBB::"}, {"surface/base", "fit"}},
    {"Highway", {"hwy/"}, {"${HWY_LIBRARY}"}, {"surface", "fit"}, true},
    {"CLI11", {"CLI/"}, {"CLI11::"}, {"cli"}},
    {"pybind11", {"pybind11/"}, {"pybind11::"}, {"python"}, true},
};

constexpr std::size_t kMostPairs = 20;  // of a header and its source, in a room

inline bool contains(const Names& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

inline bool begins_with_any(const std::string& text, const Names& beginnings) {
    return std::any_of(beginnings.begin(), beginnings.end(),
                       [&](const auto& b) { return text.starts_with(b); });
}

inline std::string folder_of(const std::string& path) { return path.substr(0, path.rfind('/')); }
inline std::string module_of(const std::string& path) { return path.substr(0, path.find('/')); }
inline bool is_source(const std::string& path) { return path.ends_with(".cpp") || path.ends_with("-inl.h"); }

inline bool may_use(const PackageRule& package, const std::string& room) {
    return contains(package.places, room) || contains(package.places, module_of(room));
}

// What a file includes, without the quotes or brackets.
inline Names includes_of(const std::string& text) {
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

// The lists of one tangi_room(HEADERS … SOURCES … VECTOR … LINK … PRIVATE …).
struct Room {
    Names files, linked, linked_privately;
    Names all_links() const {
        Names all = linked;
        all.insert(all.end(), linked_privately.begin(), linked_privately.end());
        return all;
    }
};
using Rooms = std::map<std::string, Room>;  // by folder

// By its target, tangi::A_B of the folder A/B.
inline std::string target_of(const std::string& folder) {
    std::string name = folder;
    std::replace(name.begin(), name.end(), '/', '_');
    return "tangi::" + name;
}

inline Room room_of(const std::string& cmake) {
    std::string plain;
    std::istringstream lines(cmake);
    for (std::string line; std::getline(lines, line);) plain += line.substr(0, line.find('#')) + '\n';
    Room room;
    const std::string call = "tangi_room(";
    const auto begin = plain.find(call) + call.size();
    std::istringstream words(plain.substr(begin, plain.find(')', begin) - begin));
    std::string list;
    for (std::string word; words >> word;) {
        if (contains({"HEADERS", "SOURCES", "VECTOR", "LINK", "PRIVATE"}, word))
            list = word;
        else if (list == "HEADERS" || list == "SOURCES")
            room.files.push_back(word);
        else if (list == "LINK")
            room.linked.push_back(word);
        else if (list == "PRIVATE")
            room.linked_privately.push_back(word);
    }
    return room;
}

inline Rooms rooms_of(const Tree& tree) {
    Rooms rooms;
    for (const auto& [path, text] : tree)
        if (path.ends_with("/CMakeLists.txt") && text.find("tangi_room(") != std::string::npos)
            rooms[folder_of(path)] = room_of(text);
    return rooms;
}

// Folders of the rooms that one links, and of those that they link. One that links itself is in its own.
inline std::set<std::string> reachable(const std::string& folder, const Rooms& rooms) {
    std::map<std::string, std::string> folders;
    for (const auto& [name, room] : rooms) folders[target_of(name)] = name;
    std::set<std::string> found;
    Names open = {folder};
    while (!open.empty()) {
        const Room& room = rooms.at(open.back());
        open.pop_back();
        for (const std::string& target : room.all_links())
            if (const auto next = folders.find(target);
                next != folders.end() && found.insert(next->second).second)
                open.push_back(next->second);
    }
    return found;
}

// What a room may include of packages: what it links, and what rooms that it reaches show in their headers.
inline Names visible_targets(const std::string& folder, const Rooms& rooms) {
    Names targets = rooms.at(folder).all_links();
    for (const std::string& other : reachable(folder, rooms)) {
        const Names& linked = rooms.at(other).linked;
        targets.insert(targets.end(), linked.begin(), linked.end());
    }
    return targets;
}

inline void check_package(const std::string& path, const std::string& include, const Names& targets,
                          Names& violations) {
    const std::string folder = folder_of(path);
    for (const PackageRule& package : kPackages) {
        if (!begins_with_any(include, package.includes)) continue;
        const std::string what = path + " includes " + include + ": ";
        if (!may_use(package, folder))
            violations.push_back(what + folder + " may not use " + package.name);
        else if (!package.in_headers && !is_source(path))
            violations.push_back(what + package.name + " belongs in sources");
        else if (std::none_of(targets.begin(), targets.end(),
                              [&](const auto& target) { return begins_with_any(target, package.targets); }))
            violations.push_back(what + folder + " does not link " + package.name);
    }
}

// One line for each #include that breaks a rule.
inline Names include_violations(const Tree& tree) {
    Names violations;
    const Rooms rooms = rooms_of(tree);
    for (const auto& [folder, room] : rooms) {
        const std::set<std::string> reached = reachable(folder, rooms);
        const Names targets = visible_targets(folder, rooms);
        for (const auto& [path, text] : tree) {
            if (folder_of(path) != folder || path.ends_with("CMakeLists.txt")) continue;
            for (const std::string& include : includes_of(text)) {
                const std::string what = path + " includes " + include + ": ", other = folder_of(include);
                if (include.find("../") != std::string::npos)
                    violations.push_back(what + "give the path from the root");
                else if (rooms.contains(other) && other != folder && !reached.contains(other))
                    violations.push_back(what + folder + " does not link " + target_of(other));
                else if (kModules.contains(module_of(include)) && !rooms.contains(other))
                    violations.push_back(what + "no such room");
                check_package(path, include, targets, violations);
            }
        }
    }
    return violations;
}

// One line for each link list that breaks a rule.
inline Names link_violations(const Tree& tree) {
    Names violations;
    const Rooms rooms = rooms_of(tree);
    for (const auto& [folder, room] : rooms) {
        const std::string module = module_of(folder);
        const auto rule = kModules.find(module);
        if (rule == kModules.end()) {
            violations.push_back(folder + ": module " + module + " has no rule");
            continue;
        }
        const std::set<std::string> reached = reachable(folder, rooms);
        if (reached.contains(folder)) violations.push_back(folder + " links itself, through others");
        for (const std::string& other : reached)
            if (module_of(other) != module && !contains(rule->second, module_of(other)))
                violations.push_back(folder + " reaches " + other + ", and " + module + " may not use " +
                                     module_of(other));
        for (const PackageRule& package : kPackages)
            for (const std::string& target : room.all_links()) {
                if (!begins_with_any(target, package.targets)) continue;
                if (!may_use(package, folder))
                    violations.push_back(folder + " links " + target + ": it may not use " + package.name);
                else if (!package.in_headers && contains(room.linked, target))
                    violations.push_back(folder + " links " + target + " publicly: it belongs under PRIVATE");
            }
    }
    return violations;
}

// One line for each source that is in no list, or in a folder that is no room, and each room that is too
// large.
inline Names room_violations(const Tree& tree) {
    Names violations;
    const Rooms rooms = rooms_of(tree);
    std::map<std::string, std::set<std::string>> pairs;
    for (const auto& [path, text] : tree) {
        if (path.ends_with("CMakeLists.txt")) continue;
        const std::string folder = folder_of(path), file = path.substr(folder.size() + 1);
        const std::string stem = file.substr(0, file.find_first_of(".-"));
        const auto room = rooms.find(folder);
        if (room == rooms.end())
            violations.push_back(path + ": " + folder + " is no room");
        else if (!contains(room->second.files, file) &&
                 tree.at(folder + "/CMakeLists.txt").find(" " + file) == std::string::npos)
            violations.push_back(path + ": is in no list of " + folder + "/CMakeLists.txt");
        pairs[folder].insert(stem);
    }
    for (const auto& [folder, stems] : pairs)
        if (stems.size() > kMostPairs)
            violations.push_back(folder + " has " + std::to_string(stems.size()) +
                                 " pairs of header and source");
    return violations;
}

// One line for each type that two headers define under one name: no compiler sees both, and the linker takes
// functions of either for those of the other.
inline Names type_violations(const Tree& tree) {
    static const std::regex begins(
        R"((?:^|\n)(namespace ([\w:]+) \{|(?:struct|class|enum class) (\w+)(?: final)?(?: :[^;\n]*)? \{))");
    std::map<std::string, std::string> defined;  // type -> header
    Names violations;
    for (const auto& [path, text] : tree) {
        if (!path.ends_with(".h")) continue;
        std::string within;
        for (std::sregex_iterator at(text.begin(), text.end(), begins), end; at != end; ++at) {
            if ((*at)[2].matched) within = (*at)[2];
            if (!(*at)[3].matched) continue;
            const auto [first, is_new] = defined.emplace(within + "::" + (*at)[3].str(), path);
            if (!is_new)
                violations.push_back(path + ": " + first->first + " is in " + first->second + ", too");
        }
    }
    return violations;
}

}  // namespace tangi
