#include "cli/renamed_flags.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "capture/stack/stack_calibration.h"

namespace tangi {

namespace {

struct Renamed {
    std::string_view before, now;
};
constexpr std::array<Renamed, 15> kRenamed = {{
    {"--faithful", "--residual"},
    {"--faithful-terms", "--residual-terms"},
    {"--faithful-colour-terms", "--residual-colour-terms"},
    {"--faithful-samples", "--residual-samples"},
    {"--faithful-worth-db", "--residual-min-gain-db"},
    {"--coloured-lobes", "--specular-colour"},
    {"--drawn-out-lobes", "--anisotropic-specular"},
    {"--haze", "--second-lobe-weight"},
    {"--lamp-radius-deg", "--light-radius-deg"},
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

// The flags of version 0.1 that mirror axes, which are one now.
struct AxesFlags {
    bool flip_x = false, flip_y = false;

    // Whether the word is one of them.
    bool take(const std::string& name, RenamedFlags& result) {
        if (name != "--lights-flip-x" && name != "--lights-flip-y") return false;
        (name.back() == 'x' ? flip_x : flip_y) = true;
        note(result, name,
             "--light-axes " + in_words({.flip_x = name.back() == 'x', .flip_y = name.back() == 'y'}));
        return true;
    }
    // As the one flag; beside it, they may be meant as well, or have been left over.
    void add_to(RenamedFlags& result) const {
        if (!flip_x && !flip_y) return;
        if (const std::optional<std::string> axes = value_of(result.words, "--light-axes"))
            result.given_twice = fmt::format(
                "--lights-flip-{} and --light-axes {}: both say how axes point; give one of them, "
                "or --light-axes {} where both are meant",
                flip_x ? "x" : "y", *axes, with_signs(*axes));
        else
            result.words.push_back("--light-axes=" + in_words({.flip_x = flip_x, .flip_y = flip_y}));
    }

private:
    // Of a flag and what follows it, or of "flag=value".
    static std::optional<std::string> value_of(const std::vector<std::string>& words,
                                               const std::string& flag) {
        for (std::size_t i = 0; i < words.size(); ++i) {
            if (words[i] == flag) return i + 1 < words.size() ? words[i + 1] : "";
            if (words[i].starts_with(flag + "=")) return words[i].substr(flag.size() + 1);
        }
        return std::nullopt;
    }
    // The value of --light-axes in which what was x and y is mirrored, too.
    std::string with_signs(const std::string& text) const {
        LightAxes axes = light_axes_of(text).value_or(LightAxes{});
        axes.flip_x = axes.flip_x || (axes.exchanged ? flip_y : flip_x);
        axes.flip_y = axes.flip_y || (axes.exchanged ? flip_x : flip_y);
        return in_words(axes);
    }
};

}  // namespace

RenamedFlags with_present_flags(const std::vector<std::string>& words) {
    RenamedFlags result;
    AxesFlags axes;
    for (const std::string& word : words) {
        const std::size_t end = word.find('=');
        const std::string name = word.substr(0, end);
        if (axes.take(name, result)) continue;
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
    axes.add_to(result);
    return result;
}

}  // namespace tangi
