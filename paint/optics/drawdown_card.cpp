#include "paint/optics/drawdown_card.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "paint/optics/kubelka_munk.h"
#include "surface/base/error.h"

namespace tangi {

namespace {

// The card: coated paper and printed black, as of the charts that paint is tested on.
const Rgb kPaper(0.82f), kBlack(0.02f), kInk(0.05f);
constexpr float kThick_mm = 0.5f;  // of swatches: hides with every paint but glazes

// Smooth noise along a line, -1..1; the same on every machine.
float noise(float x, std::uint32_t seed) {
    const auto at = [&](std::int32_t i) {
        std::uint32_t h = static_cast<std::uint32_t>(i) * 0x9E3779B1u + seed * 0x85EBCA77u;
        h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
        h = (h ^ (h >> 12)) * 0x297A2D39u;
        return static_cast<float>(h ^ (h >> 15)) * (2.0f / 4294967296.0f) - 1;
    };
    const float whole = std::floor(x), t = x - whole, smooth = t * t * (3 - 2 * t);
    const auto i = static_cast<std::int32_t>(whole);
    return (1 - smooth) * at(i) + smooth * at(i + 1);
}

// A rectangle in parts of the card's width.
struct Box {
    float x0, y0, x1, y1;
};
constexpr float kHeight = 0.80f;
constexpr Box kSwatches[] = {
    {0.05f, 0.13f, 0.34f, 0.36f}, {0.355f, 0.13f, 0.645f, 0.36f}, {0.66f, 0.13f, 0.95f, 0.36f}};
constexpr Box kStripes{0.05f, 0.41f, 0.95f, 0.71f};
constexpr Box kDrawdown{0.075f, 0.435f, 0.925f, 0.685f};

bool within(const Box& box, float x, float y) {
    return x >= box.x0 && x < box.x1 && y >= box.y0 && y < box.y1;
}

// How much of a film there is near the wobbling edges of its box: 0 outside, 1 inside, and one pixel between.
float cover(const Box& box, float x, float y, float pixel, std::uint32_t seed) {
    const float wobble_x = 0.0012f * noise(y * 45, seed) + 0.0008f * noise(y * 120, seed + 1);
    const float wobble_y = 0.0010f * noise(x * 35, seed + 2);
    const float inside = std::min(
        {x - box.x0 - wobble_x, box.x1 + wobble_x - x, y - box.y0 - wobble_y, box.y1 + wobble_y - y});
    return std::clamp(inside / pixel + 0.5f, 0.0f, 1.0f);
}

// The card of one paint: what lies below, and how much paint and white is on it.
struct Card {
    int width, height;
    std::vector<Rgb> below;
    std::vector<float> paint_mm, white_mm;

    Card(const DrawdownOptions& options, std::uint32_t seed)
        : width(options.card_px), height(static_cast<int>(std::lround(kHeight * static_cast<float>(width)))) {
        const float pixel = 1 / static_cast<float>(width);
        const float tint = static_cast<float>(options.tint), parts[] = {1, tint, tint / 5};
        for (int row = 0; row < height; ++row)
            for (int column = 0; column < width; ++column) {
                const float x = (static_cast<float>(column) + 0.5f) * pixel,
                            y = (static_cast<float>(row) + 0.5f) * pixel;
                // Black, white, black, white, along the way that the paint is drawn.
                const bool black =
                    within(kStripes, x, y) &&
                    static_cast<int>((y - kStripes.y0) / (kStripes.y1 - kStripes.y0) * 4) % 2 == 0;
                below.push_back(black ? kBlack : kPaper);
                float paint = 0, white = 0;
                for (std::uint32_t i = 0; i < 3; ++i) {
                    const float film_mm = kThick_mm * cover(kSwatches[i], x, y, pixel, seed + 10 * i);
                    paint += parts[i] * film_mm;
                    white += (1 - parts[i]) * film_mm;
                }
                paint += drawn_mm(x, y, pixel, seed + 40, static_cast<float>(options.thickest_mm));
                paint_mm.push_back(paint);
                white_mm.push_back(white);
            }
    }

    // The gap under the blade widens along the way; grains under it leave streaks.
    static float drawn_mm(float x, float y, float pixel, std::uint32_t seed, float thickest_mm) {
        const float along = std::clamp((x - kDrawdown.x0) / (kDrawdown.x1 - kDrawdown.x0), 0.0f, 1.0f);
        const float streaks = 1 + 0.06f * noise(y * 160, seed) + 0.05f * noise(y * 420, seed + 3) +
                              0.02f * noise(x * 25 + 7 * noise(y * 30, seed + 5), seed + 4);
        return thickest_mm * along * streaks * cover(kDrawdown, x, y, pixel, seed + 6);
    }
};

// Writes in the card's ink, smaller where it would be wider than `most_px`. Letters that the font does not
// have are '?'.
void write_text(Image<Rgb>& picture, const std::string& text, int x, int y, double height_px, int most_px) {
    constexpr int kFont = cv::FONT_HERSHEY_DUPLEX;
    double scale = height_px / 22;
    const int wide = cv::getTextSize(text, kFont, scale, 1, nullptr).width;
    if (wide > most_px) scale *= static_cast<double>(most_px) / wide;
    cv::Mat mask(picture.height(), picture.width(), CV_8U, cv::Scalar(0));
    cv::putText(mask, text, {x, y}, kFont, scale, cv::Scalar(255), std::max(1, static_cast<int>(scale * 1.2)),
                cv::LINE_AA);
    for (int row = 0; row < picture.height(); ++row)
        for (int column = 0; column < picture.width(); ++column) {
            const float ink = static_cast<float>(mask.at<unsigned char>(row, column)) / 255;
            if (ink > 0) picture(column, row) = picture(column, row) * (1 - ink) + kInk * ink;
        }
}

Image<Rgb> card_of(const Pigment& paint, const Pigment& white, Illuminant illuminant,
                   const DrawdownOptions& options, std::uint32_t seed) {
    const Card card(options, seed);
    Image<Rgb> picture(card.width, card.height);
    const Pigment both[] = {paint, white};
    const std::span<const float> volumes[] = {card.paint_mm, card.white_mm};
    FilmBatch(both, illuminant).look(volumes, card.below, picture.pixels());

    const double size = card.width;
    const auto px = [&](double part) { return static_cast<int>(std::lround(part * size)); };
    write_text(picture, paint.name + (paint.approximate() ? " (approx.)" : ""), px(0.05), px(0.095),
               0.045 * size, px(0.9));
    const std::pair<double, double> marks[] = {
        {0, 0.075}, {0.5, 0.46}, {1, 0.78}};  // part of the thickest, place
    for (const auto& [part, place] : marks)
        write_text(picture, fmt::format("{:.3g}{}", part * options.thickest_mm, part == 1 ? " mm" : ""),
                   px(place), px(0.765), 0.033 * size, px(0.17));
    return picture;
}

}  // namespace

const Pigment& white_of(const Palette& palette) {
    const auto luminance_of = [](const Pigment& p) {
        return xyz_of(opaque_look({p.k, p.s}), Illuminant::d65).y;
    };
    const Pigment* lightest = nullptr;
    double most = 0.7;
    for (const Pigment& paint : palette.paints)
        if (!is_clear(paint) && luminance_of(paint) > most) lightest = &paint, most = luminance_of(paint);
    // Yellows are light, too.
    if (lightest) {
        const Lab lab = lab_under(opaque_look({lightest->k, lightest->s}));
        if (std::hypot(lab.a, lab.b) < 12) return *lightest;
    }
    return artist_acrylics().at("Titanium White");
}

Image<Rgb> drawdown_cards(const Palette& palette, Illuminant illuminant, const DrawdownOptions& options,
                          const Progress& progress) {
    validate(options);
    const int count = static_cast<int>(palette.paints.size());
    const int columns = std::max(1, std::min(options.columns, count));
    const int card_height = static_cast<int>(std::lround(kHeight * static_cast<float>(options.card_px)));
    const int gap = std::max(2, options.card_px / 40), rows = (count + columns - 1) / columns;
    const std::int64_t width = gap + std::int64_t(columns) * (options.card_px + gap);
    const std::int64_t height = gap + std::int64_t(rows) * (card_height + gap);
    if (width * height > 100'000'000)
        fail("{} cards of {} x {} pixels make a picture of {} x {}; make them smaller with --card-px", count,
             options.card_px, card_height, width, height);

    const Pigment& white = white_of(palette);
    Image<Rgb> sheet(static_cast<int>(width), static_cast<int>(height), Rgb(0.28f));
    for (int i = 0; i < count; ++i) {
        const Image<Rgb> card = card_of(palette.paints[static_cast<std::size_t>(i)], white, illuminant,
                                        options, static_cast<std::uint32_t>(100 * i));
        const int left = gap + i % columns * (options.card_px + gap),
                  top = gap + i / columns * (card_height + gap);
        for (int y = 0; y < card.height(); ++y)
            std::copy(card.row(y).begin(), card.row(y).end(), sheet.row(top + y).begin() + left);
        report(progress, "cards", static_cast<double>(i + 1) / count);
    }
    return sheet;
}

}  // namespace tangi
