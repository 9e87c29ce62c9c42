#include "capture/photo/colour_channels.h"

#include <fmt/ranges.h>

#include <algorithm>

#include "surface/base/json_text.h"
#include "surface/base/words.h"

namespace tangi {

namespace {

constexpr const char* kStoreColours =
    "store red, green and blue of each photograph (channels R, G and B), or one band as a grey picture";

// "r" of "diffuse.R", and the layer "diffuse.".
struct NamedChannel {
    std::string layer, channel;
};
NamedChannel in_layer(const std::string& name) {
    const std::size_t point = name.rfind('.') + 1;  // 0 where there is none
    return {name.substr(0, point), lower_case(name.substr(point))};
}

bool is_one_of(const std::string& name, std::initializer_list<std::string_view> of) {
    return std::find(of.begin(), of.end(), name) != of.end();
}

// Where red, green and blue of one layer begin.
std::vector<int> triples(const std::vector<std::string>& names) {
    std::vector<int> found;
    for (std::size_t i = 0; i + 2 < names.size(); ++i) {
        const NamedChannel r = in_layer(names[i]), g = in_layer(names[i + 1]), b = in_layer(names[i + 2]);
        if (r.layer == g.layer && g.layer == b.layer && is_one_of(r.channel, {"r", "red"}) &&
            is_one_of(g.channel, {"g", "green"}) && is_one_of(b.channel, {"b", "blue"}))
            found.push_back(static_cast<int>(i));
    }
    return found;
}

ColourChannels by_names(const std::vector<std::string>& names, int alpha) {
    const std::vector<int> colours = triples(names);
    for (const int first : colours)  // what has no layer is the picture
        if (colours.size() == 1 || in_layer(names[static_cast<std::size_t>(first)]).layer.empty())
            return {first, 3};
    if (colours.empty() && names.size() == (alpha >= 0 ? 2u : 1u)) return {alpha == 0 ? 1 : 0, 1};
    const auto is_grey = [](const std::string& name) {
        return is_one_of(lower_case(name), {"y", "l", "grey", "gray", "luminance"});
    };
    const auto chroma = std::count_if(names.begin(), names.end(), [](const std::string& name) {
        return is_one_of(lower_case(name), {"ry", "by", "x"});
    });
    if (const auto grey = std::find_if(names.begin(), names.end(), is_grey);
        colours.empty() && chroma == 0 && grey != names.end())
        return {static_cast<int>(grey - names.begin()), 1};
    constexpr std::size_t most = 8;
    std::vector<std::string> shown;  // which may be any bytes
    for (std::size_t i = 0; i < std::min(most, names.size()); ++i) shown.push_back(shortened(names[i]));
    return {0, 0,
            fmt::format("its channels ({}{}) do not say which are red, green and blue; {}",
                        fmt::join(shown, ", "), names.size() > most ? ", …" : "", kStoreColours)};
}

}  // namespace

ColourChannels colour_channels(const std::vector<std::string>& names, int alpha, bool names_tell) {
    if (names_tell) return by_names(names, alpha);
    const std::size_t count = names.size(), colours = count >= 3 ? 3 : 1;
    if (count > colours + 1)
        return {0, 0,
                fmt::format("has {} channels, and nothing says which are red, green and blue; {}", count,
                            kStoreColours)};
    ColourChannels first{0, static_cast<int>(colours)};
    if (count > colours && alpha < 0)
        first.doubt = fmt::format("its channel {} is no alpha, and not used: {}", count,
                                  colours == 3 ? "the first three are taken for red, green and blue"
                                               : "the first is taken for a grey picture");
    return first;
}

}  // namespace tangi
