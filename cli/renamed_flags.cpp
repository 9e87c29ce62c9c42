#include "cli/renamed_flags.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace tangi {

namespace {

struct Renamed {
    std::string_view before, now;
};
constexpr std::array<Renamed, 16> kRenamed = {{
    {"--faithful", "--residual"},
    {"--faithful-terms", "--residual-terms"},
    {"--faithful-colour-terms", "--residual-colour-terms"},
    {"--faithful-samples", "--residual-samples"},
    {"--faithful-worth-db", "--residual-min-gain-db"},
    {"--coloured-lobes", "--specular-colour"},
    {"--drawn-out-lobes", "--anisotropic-specular"},
    {"--haze", "--second-lobe-weight"},
    {"--lamp-radius-deg", "--light-radius-deg"},
    {"--worth-db", "--min-gain-db"},
    {"--matt-ball", "--diffuse-sphere"},
    {"--no-balls", "--no-spheres"},
    {"--ball-radius-mm", "--sphere-radius-mm"},
    {"--ball-height-mm", "--sphere-height-mm"},
    {"--lamps", "--illuminants"},
    {"--lights-turn", "--light-rotation-deg"},
}};

void note(RenamedFlags& result, std::string_view before, std::string_view now) {
    std::string text = fmt::format("{} is now {}; the old name will go in a later version", before, now);
    if (std::find(result.notes.begin(), result.notes.end(), text) == result.notes.end())
        result.notes.push_back(std::move(text));
}

}  // namespace

RenamedFlags with_present_flags(const std::vector<std::string>& words) {
    RenamedFlags result;
    bool flip_x = false, flip_y = false;
    for (const std::string& word : words) {
        const std::size_t end = word.find('=');
        const std::string name = word.substr(0, end);
        if (name == "--lights-flip-x" || name == "--lights-flip-y") {
            (name.back() == 'x' ? flip_x : flip_y) = true;
            note(result, name, name.back() == 'x' ? "--light-axes -x,y,z" : "--light-axes x,-y,z");
            continue;
        }
        const auto renamed = std::find_if(kRenamed.begin(), kRenamed.end(),
                                          [&](const Renamed& r) { return r.before == name; });
        if (renamed == kRenamed.end()) {
            result.words.push_back(word);
            continue;
        }
        note(result, renamed->before, renamed->now);
        result.words.push_back(std::string(renamed->now) +
                               (end == std::string::npos ? "" : word.substr(end)));
    }
    if (flip_x || flip_y)
        result.words.push_back(fmt::format("--light-axes={}x,{}y,z", flip_x ? "-" : "", flip_y ? "-" : ""));
    return result;
}

}  // namespace tangi
