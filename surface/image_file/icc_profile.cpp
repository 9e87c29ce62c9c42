#include "surface/image_file/icc_profile.h"

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <string_view>
#include <utility>
#include <vector>

#include "surface/base/json_text.h"

namespace tangi {

namespace {

void put16(std::string& to, std::uint32_t value) {
    to += static_cast<char>(value >> 8 & 255);
    to += static_cast<char>(value & 255);
}
void put32(std::string& to, std::uint32_t value) {
    put16(to, value >> 16);
    put16(to, value & 65535);
}
void put_fixed(std::string& to, double value) {  // s15Fixed16Number
    put32(to, static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(value * 65536))));
}

std::string fixed_numbers(std::string_view type, std::initializer_list<double> values) {
    std::string tag(type);
    put32(tag, 0);
    for (const double value : values) put_fixed(tag, value);
    return tag;
}

std::string text(std::string_view words) {  // multiLocalizedUnicodeType, in English
    std::string tag = "mluc";
    put32(tag, 0);
    put32(tag, 1);   // one language
    put32(tag, 12);  // bytes of its entry
    tag += "enUS";
    put32(tag, static_cast<std::uint32_t>(2 * words.size()));
    put32(tag, 28);  // where it begins
    for (const char c : words) put16(tag, static_cast<unsigned char>(c));
    return tag;
}

std::string srgb_curve() {  // parametricCurveType, function 3: (a x + b)^g from d on, c x below
    std::string tag = "para";
    put32(tag, 0);
    put16(tag, 3);
    put16(tag, 0);
    for (const double value : {2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045}) put_fixed(tag, value);
    return tag;
}

}  // namespace

std::string srgb_icc_profile() {
    const std::vector<std::pair<std::string_view, std::string>> tags = {
        {"desc", text("sRGB")},
        {"cprt", text("CC0")},
        {"wtpt", fixed_numbers("XYZ ", {0.9642, 1, 0.8249})},
        {"chad", fixed_numbers("sf32", {1.04788, 0.02292, -0.05022, 0.02959, 0.99048, -0.01707, -0.00925,
                                        0.01508, 0.75168})},
        {"rXYZ", fixed_numbers("XYZ ", {0.43607, 0.22249, 0.01392})},
        {"gXYZ", fixed_numbers("XYZ ", {0.38515, 0.71687, 0.09708})},
        {"bXYZ", fixed_numbers("XYZ ", {0.14307, 0.06061, 0.71410})},
        {"rTRC", srgb_curve()},
        {"gTRC", {}},  // the same
        {"bTRC", {}}};
    std::string table, data;
    const auto first = static_cast<std::uint32_t>(128 + 4 + 12 * tags.size());
    put32(table, static_cast<std::uint32_t>(tags.size()));
    std::uint32_t at = 0, length = 0;
    for (const auto& [signature, content] : tags) {
        if (!content.empty()) {
            at = first + static_cast<std::uint32_t>(data.size());
            length = static_cast<std::uint32_t>(content.size());
            data += content;
            data.resize((data.size() + 3) / 4 * 4, '\0');
        }
        table += signature;
        put32(table, at);
        put32(table, length);
    }
    std::string header;
    put32(header, first + static_cast<std::uint32_t>(data.size()));
    put32(header, 0);
    put32(header, 0x04300000);
    header += "mntrRGB XYZ ";
    for (const std::uint32_t date : {2026, 1, 1, 0, 0, 0}) put16(header, date);
    header += "acsp";
    header.resize(68, '\0');  // platform, flags, device, intent: none
    for (const double d50 : {0.9642, 1.0, 0.8249}) put_fixed(header, d50);
    header.resize(128, '\0');
    return header + table + data;
}

namespace {

std::uint64_t icc_number(std::string_view bytes, std::uint64_t at) {
    std::uint64_t number = 0;
    for (const char byte : bytes.substr(at, 4)) number = number << 8 | static_cast<unsigned char>(byte);
    return number;
}

// Texts in several languages: a record of 12 bytes each, with the length of the text and where it begins in
// the tag (ICC.1:2010, 10.13).
bool texts_lie_in(std::string_view tag, std::string_view from_tag_on) {
    if (tag.size() < 16) return false;
    const std::uint64_t records = icc_number(tag, 8);
    if (icc_number(tag, 12) != 12) return true;  // nobody reads them
    if (16 + 12 * records > tag.size()) return false;
    for (std::uint64_t i = 0; i < records; ++i) {
        const std::uint64_t length = icc_number(tag, 16 + 12 * i + 4),
                            begin = icc_number(tag, 16 + 12 * i + 8);
        if (begin + length > from_tag_on.size()) return false;
    }
    return true;
}

}  // namespace

std::optional<std::string> damage_of_icc(std::string_view profile) {
    constexpr std::uint64_t header = 128, entry = 12;
    if (profile.size() < header + 4 || profile.substr(36, 4) != "acsp") return {};
    const std::uint64_t tags = icc_number(profile, header);
    if (header + 4 + entry * tags > profile.size())
        return fmt::format("it has {} tags by its header, for which it is too short", tags);
    for (std::uint64_t i = 0; i < tags; ++i) {
        const std::uint64_t at = header + 4 + entry * i, offset = icc_number(profile, at + 4),
                            size = icc_number(profile, at + 8);
        const std::string name = shortened(profile.substr(at, 4));
        if (offset + size > profile.size()) return fmt::format("its tag '{}' lies outside of it", name);
        if (offset + 4 > profile.size()) return fmt::format("its tag '{}' begins at its end", name);
        const std::string_view type = profile.substr(offset, 4);
        const bool too_short = (type == "text" && size < 8) || (type == "desc" && size < 12);
        if (too_short ||
            (type == "mluc" && !texts_lie_in(profile.substr(offset, size), profile.substr(offset))))
            return fmt::format("the text in its tag '{}' is longer than the tag", name);
    }
    return {};
}

}  // namespace tangi
