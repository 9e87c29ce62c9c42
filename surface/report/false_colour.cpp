#include "surface/report/false_colour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "surface/base/error.h"
#include "surface/base/parallel.h"
#include "surface/reflectance/anisotropy.h"

namespace tangi {

namespace {

constexpr int kEntries = 256;
using Table = std::array<Rgb, kEntries>;

// Linear Rec. 709 from L*, chroma and hue [deg], white D65 (CIE 1976; IEC 61966-2-1 for the matrix).
glm::dvec3 linear_from_lch(double l, double c, double hue_deg) {
    const double hue = hue_deg * std::numbers::pi / 180;
    const double fy = (l + 16) / 116, fx = fy + c * std::cos(hue) / 500, fz = fy - c * std::sin(hue) / 200;
    const auto inverse = [](double f) {
        constexpr double epsilon = 6.0 / 29;
        return f > epsilon ? f * f * f : 3 * epsilon * epsilon * (f - 4.0 / 29);
    };
    const double x = 0.95047 * inverse(fx), y = inverse(fy), z = 1.08883 * inverse(fz);
    return {3.2404542 * x - 1.5371385 * y - 0.4985314 * z, -0.9692660 * x + 1.8760108 * y + 0.0415560 * z,
            0.0556434 * x - 0.2040259 * y + 1.0572252 * z};
}

// sRGB of a colour, its chroma lowered as far as the gamut demands.
Rgb srgb_from_lch(double l, double chroma, double hue_deg) {
    const auto inside = [&](double c) {
        const glm::dvec3 rgb = linear_from_lch(l, c, hue_deg);
        return std::min({rgb.x, rgb.y, rgb.z}) >= -1e-6 && std::max({rgb.x, rgb.y, rgb.z}) <= 1 + 1e-6;
    };
    double lo = 0, hi = chroma;
    for (int i = 0; i < 40 && !inside(hi); ++i) (inside((lo + hi) / 2) ? lo : hi) = (lo + hi) / 2;
    const Rgb rgb(linear_from_lch(l, inside(hi) ? hi : lo, hue_deg));
    return glm::clamp(Transfer{Transfer::Kind::srgb}.encode(rgb), 0.0f, 1.0f);
}

Table make_sequential() {
    Table table;
    for (int i = 0; i < kEntries; ++i) {
        const double t = i / double(kEntries - 1);
        const double hue = 310 - 210 * std::pow(t, 1.15);  // violet, blue, teal, green, yellow
        const double chroma = 42 + 34 * std::pow(std::abs(2 * t - 1), 2);  // the ends may glow, teal cannot
        table[static_cast<std::size_t>(i)] = srgb_from_lch(12 + 80 * t, chroma, hue);
    }
    return table;
}

Table make_diverging() {
    Table table;
    for (int i = 0; i < kEntries; ++i) {
        const double t = 2 * i / double(kEntries - 1) - 1, size = std::abs(t);
        table[static_cast<std::size_t>(i)] = srgb_from_lch(96 - 58 * size, 68 * size, t < 0 ? 272 : 32);
    }
    return table;
}

const Table& table_of(ColourMap map) {
    static const Table sequential = make_sequential(), diverging = make_diverging();
    return map == ColourMap::sequential ? sequential : diverging;
}

cv::Mat view(const Image<Rgb>& picture) {
    return {picture.height(), picture.width(), CV_32FC3, const_cast<Rgb*>(picture.data())};
}

std::string ascii(std::string_view text) {
    std::string plain;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte >= 0x20 && byte < 0x7f)
            plain += c;
        else if (byte < 0x80 || byte >= 0xc0)  // continuation bytes belong to a character that is already '?'
            plain += '?';
    }
    return plain;
}

constexpr int kFont = cv::FONT_HERSHEY_DUPLEX;
constexpr int kSupersampling = 4;
constexpr double kCapital = 22;  // [pixels] height of the font's capitals at scale 1

int stroke_of(int size) {
    return std::max(1, static_cast<int>(std::lround(size * kSupersampling / kCapital * 1.3)));
}

}  // namespace

Rgb colour_at(ColourMap map, double t) {
    if (std::isnan(t)) return kNoValue;
    const double position = std::clamp(t, 0.0, 1.0) * (kEntries - 1);
    const auto i = std::min(static_cast<std::size_t>(position), std::size_t{kEntries - 2});
    return glm::mix(table_of(map)[i], table_of(map)[i + 1],
                    static_cast<float>(position - static_cast<double>(i)));
}

ValueRange robust_range(const Image<float>& values, const PixelMask& mask, double part) {
    const double lo = percentile(values, part, mask), hi = percentile(values, 1 - part, mask);
    if (std::isnan(lo)) return {};
    const double least = std::max(1e-6, 1e-4 * std::max(std::abs(lo), std::abs(hi)));
    if (hi - lo < least) return {lo - least, hi + least};
    return {lo, hi};
}

void map_row(std::span<const float> values, double lo, double hi, ColourMap map,
             std::span<const unsigned char> mask, std::span<Rgb> row) {
    for (std::size_t x = 0; x < row.size(); ++x)
        row[x] = mask.empty() || mask[x] ? colour_at(map, (values[x] - lo) / (hi - lo)) : kNoValue;
}

Image<Rgb> map_picture(const Image<float>& values, double lo, double hi, ColourMap map,
                       const PixelMask& mask) {
    TP_REQUIRE(hi > lo, "the range is not empty");
    TP_REQUIRE(mask.empty() || mask.region() == values.region(), "the mask has the size of the map");
    Image<Rgb> picture(values.width(), values.height());
    parallel_for(0, values.height(), 32, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            map_row(values.row(y), lo, hi, map, mask.empty() ? std::span<const unsigned char>() : mask.row(y),
                    picture.row(y));
    });
    return picture;
}

Image<Rgb> normal_picture(const Image<Vec3>& normal, const PixelMask& mask) {
    Image<Rgb> picture(normal.width(), normal.height(), kNoValue);
    for (std::size_t i = 0; i < normal.size(); ++i)
        if (mask.empty() || mask.pixels()[i])
            picture.pixels()[i] = glm::clamp(0.5f + 0.5f * normal.pixels()[i], 0.0f, 1.0f);
    return picture;
}

std::vector<double> ticks(const ValueRange& range, int most) {
    TP_REQUIRE(range.hi > range.lo && most >= 2, "a range and two ticks at least");
    const double slack = 1e-9 * (range.hi - range.lo);
    for (double power = std::pow(10, std::floor(std::log10((range.hi - range.lo) / most)) - 1);; power *= 10)
        for (const double factor : {1.0, 2.0, 5.0}) {
            const double step = power * factor;
            const auto first = std::llround(std::ceil((range.lo - slack) / step));
            const auto last = std::llround(std::floor((range.hi + slack) / step));
            if (last - first + 1 > most) continue;
            std::vector<double> result;
            for (auto i = first; i <= last; ++i) result.push_back(static_cast<double>(i) * step);
            return result;
        }
}

std::string tick_label(double value, const ValueRange& range) {
    const int digits = std::clamp(static_cast<int>(std::ceil(1 - std::log10(range.hi - range.lo))), 0, 9);
    std::string label = fmt::format("{:.{}f}", value, digits);
    if (label.find('.') != std::string::npos) label.erase(label.find_last_not_of('0') + 1);
    if (label.ends_with('.')) label.pop_back();
    return label == "-0" ? "0" : label;
}

Image<Rgb> legend(ColourMap map, const ValueRange& range, std::string_view unit, int width, int height,
                  const LegendColours& colours) {
    const auto& [ink, paper] = colours;
    TP_REQUIRE(width >= 40 && height >= 16, "a legend has room for its labels");
    Image<Rgb> picture(width, height, paper);
    const int size = std::max(6, height * 3 / 10), bar = height - 2 * size - 1;
    const std::string suffix = unit.empty() || unit == "1" ? std::string() : fmt::format(" {}", unit);
    // Labels are centred on their ticks: the first and the last stand out by half their width, and by the
    // unit.
    const int half = std::max(text_width(tick_label(range.lo, range), size),
                              text_width(tick_label(range.hi, range), size)) /
                     2;
    const int left = std::min(half + 2, width / 4),
              right = std::max(width - half - 2 - text_width(suffix, size), width / 2);
    for (int y = 0; y < bar; ++y)
        for (int x = left; x < right; ++x) picture(x, y) = colour_at(map, (x - left + 0.5) / (right - left));
    const int most = std::max(2, (right - left) / std::max(1, text_width("-0.000", size)));
    const std::vector<double> at = ticks(range, std::min(most, 7));
    for (const double value : at) {
        const double t = (value - range.lo) / (range.hi - range.lo);
        const int x = std::clamp(left + static_cast<int>(t * (right - left)), left, right - 1);
        for (int y = bar; y < bar + size / 2; ++y) picture(x, y) = ink;
        const std::string label = tick_label(value, range);
        const int start = std::max(0, x - text_width(label, size) / 2);
        draw_text(picture, value == at.back() ? label + suffix : label, start, bar + size * 3 / 4, size, ink);
    }
    return picture;
}

int text_width(std::string_view text, int size) {
    int baseline = 0;
    const std::string plain = ascii(text);
    return cv::getTextSize(plain, kFont, size * kSupersampling / kCapital, stroke_of(size), &baseline).width /
           kSupersampling;
}

void draw_text(Image<Rgb>& picture, std::string_view text, int x, int y, int size, const Rgb& ink) {
    const std::string plain = ascii(text);
    if (plain.empty()) return;
    // Drawn large as coverage, then averaged: the fonts are made of strokes, which look ragged when drawn
    // small.
    const int pad = size / 2 + 1, width = text_width(text, size) + 2 * pad, height = 2 * size + 2 * pad;
    cv::Mat large(height * kSupersampling, width * kSupersampling, CV_32F, cv::Scalar(0)), coverage;
    cv::putText(large, plain, {pad * kSupersampling, (pad + size) * kSupersampling}, kFont,
                size * kSupersampling / kCapital, cv::Scalar(1), stroke_of(size), cv::LINE_8);
    cv::resize(large, coverage, {width, height}, 0, 0, cv::INTER_AREA);
    for (int v = 0; v < height; ++v)
        for (int u = 0; u < width; ++u) {
            const int px = x + u - pad, py = y + v - pad;
            if (px < 0 || py < 0 || px >= picture.width() || py >= picture.height()) continue;
            picture(px, py) = glm::mix(picture(px, py), ink, coverage.at<float>(v, u));
        }
}

Image<Rgb> resized(const Image<Rgb>& picture, int width, int height) {
    TP_REQUIRE(!picture.empty() && width > 0 && height > 0, "pictures have pixels");
    Image<Rgb> result(width, height);
    cv::Mat target = view(result);
    cv::resize(view(picture), target, {width, height}, 0, 0,
               width < picture.width() ? cv::INTER_AREA : cv::INTER_LINEAR);
    return result;
}

Image<Rgb> shrunk(int width, int height, int longest, const PictureRow& draw) {
    const int side = std::max(width, height);
    const double scale = std::min(1.0, static_cast<double>(longest) / side);
    const auto reduced = [&](int pixels) {
        return std::max(1, static_cast<int>(std::lround(pixels * scale)));
    };
    Image<Rgb> result(reduced(width), reduced(height));
    const double step_x = static_cast<double>(width) / result.width();
    const double step_y = static_cast<double>(height) / result.height();
    parallel_for(0, result.height(), 16, [&](int begin, int end) {
        std::vector<Rgb> row(static_cast<std::size_t>(width)), sum(row.size());
        for (int v = begin; v < end; ++v) {
            std::fill(sum.begin(), sum.end(), Rgb(0));
            const double top = v * step_y, bottom = std::min((v + 1) * step_y, static_cast<double>(height));
            for (int y = static_cast<int>(top); y < bottom; ++y) {
                draw(y, row);
                const auto part =
                    static_cast<float>((std::min(y + 1.0, bottom) - std::max<double>(y, top)) / step_y);
                for (std::size_t x = 0; x < row.size(); ++x) sum[x] += part * row[x];
            }
            for (int u = 0; u < result.width(); ++u) {
                const double left = u * step_x,
                             right = std::min((u + 1) * step_x, static_cast<double>(width));
                Rgb mean(0);
                for (int x = static_cast<int>(left); x < right; ++x)
                    mean +=
                        static_cast<float>((std::min(x + 1.0, right) - std::max<double>(x, left)) / step_x) *
                        sum[static_cast<std::size_t>(x)];
                result(u, v) = mean;
            }
        }
    });
    return result;
}

Image<Rgb> shrunk(const Image<Rgb>& picture, int longest) {
    if (std::max(picture.width(), picture.height()) <= longest) return picture;
    return shrunk(picture.width(), picture.height(), longest, [&](int y, std::span<Rgb> row) {
        std::copy(picture.row(y).begin(), picture.row(y).end(), row.begin());
    });
}

namespace {

using FloatMap = std::function<Image<float>(const Surface&)>;

// The ranges that the pixels of a surface have; only of what was measured.
class Ranges {
public:
    explicit Ranges(const Surface& pixels)
        : mask_(measured(pixels.confidence)),
          any_(std::any_of(mask_.pixels().begin(), mask_.pixels().end(),
                           [](unsigned char m) { return m != 0; })) {}

    ValueRange of(const Image<float>& map) const { return any_ ? robust_range(map, mask_) : ValueRange{}; }
    ValueRange from_zero(const Image<float>& map) const { return {0, std::max(of(map).hi, 1e-3)}; }

private:
    const PixelMask mask_;
    const bool any_;  // pixels of the mask
};

std::function<Image<Rgb>(const Surface&)> scalar(FloatMap map, const ValueRange& range) {
    return [map = std::move(map), range](const Surface& s) {
        return map_picture(map(s), range.lo, range.hi, ColourMap::sequential, measured(s.confidence));
    };
}

std::function<Image<Rgb>(const Surface&)> colours(Image<Rgb> Surface::*map) {
    return [map](const Surface& s) {
        Image<Rgb> shown(s.width(), s.height(), kNoValue);
        for (std::size_t i = 0; i < shown.size(); ++i)
            if (s.confidence.pixels()[i] > 0)
                shown.pixels()[i] =
                    glm::min(Transfer{Transfer::Kind::srgb}.encode((s.*map).pixels()[i]), Rgb(1));
        return shown;
    };
}

Image<float> stretches_of(const Surface& surface) {
    Image<float> stretch(surface.width(), surface.height());
    for (std::size_t i = 0; i < stretch.size(); ++i)
        stretch.pixels()[i] =
            glm::length(stretch_of(surface.lobe_axes.pixels()[i], surface.roughness.pixels()[i]));
    return stretch;
}

}  // namespace

std::vector<MapLook> map_looks(const Surface& pixels) {
    const Ranges ranges(pixels);
    const ValueRange height = ranges.of(pixels.height_mm), specular = ranges.from_zero(pixels.specular);
    const ValueRange roughness = ranges.from_zero(pixels.roughness), confidence{0, 1};
    std::vector<MapLook> maps;
    maps.push_back({"height", "Height", "h", "Relief above the mean plane of the support.",
                    pixels.scale_known ? "mm" : "pixels", height,
                    scalar([](const Surface& s) { return s.height_mm; }, height)});
    maps.push_back({"normal", "Normals", "n",
                    "Direction the surface faces: red right, green up, blue to the viewer.", "1",
                    std::nullopt,
                    [](const Surface& s) { return normal_picture(s.normal, measured(s.confidence)); }});
    maps.push_back({"diffuse", "Diffuse colour", "ρd", "Colour of matt reflection, shown as sRGB.", "1",
                    std::nullopt, colours(&Surface::diffuse)});
    maps.push_back({"specular", "Specular", "ρs", "Strength of the gloss.", "1", specular,
                    scalar([](const Surface& s) { return s.specular; }, specular)});
    maps.push_back({"roughness", "Roughness", "α",
                    "Width of the gloss: small is mirror-like, large is satin.", "1", roughness,
                    scalar([](const Surface& s) { return s.roughness; }, roughness)});
    if (!pixels.specular_colour.empty())
        maps.push_back({"lobe", "Colour of the gloss", "", "White, or a metal's own; shown as sRGB.", "1",
                        std::nullopt, colours(&Surface::specular_colour)});
    if (!pixels.lobe_axes.empty()) {
        const ValueRange range = ranges.from_zero(stretches_of(pixels));
        maps.push_back({"anisotropy", "Stretch of the gloss", "",
                        "How much wider it is along one direction than on the mean, as a logarithm.", "1",
                        range, scalar(stretches_of, range)});
    }
    maps.push_back({"confidence", "Confidence", "", "How certain the fit is: 0 not measured, 1 certain.", "1",
                    confidence, scalar([](const Surface& s) { return s.confidence; }, confidence)});
    return maps;
}

std::vector<MapPicture> map_pictures(const Surface& surface, int longest) {
    std::vector<MapPicture> pictures;
    for (MapLook& map : map_looks(surface))
        pictures.push_back({std::move(map.key), std::move(map.title), std::move(map.symbol),
                            std::move(map.meaning), std::move(map.unit), map.range,
                            shrunk(map.draw(surface), longest)});
    return pictures;
}

}  // namespace tangi
