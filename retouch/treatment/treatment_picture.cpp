#include "retouch/treatment/treatment_picture.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "retouch/treatment/treatment_area.h"
#include "surface/image/opencv_view.h"
#include "surface/render/relight.h"

namespace tangi {

namespace {

void encode(Image<Rgb>& linear, float gain) {
    const Transfer srgb{Transfer::Kind::srgb};
    for (Rgb& c : linear.pixels()) c = glm::clamp(srgb.encode(glm::max(c * gain, Rgb(0))), Rgb(0), Rgb(1));
}

// The painting in light grey, on which colours can be seen.
Image<Rgb> in_grey(const Surface& surface) {
    Image<Rgb> grey = colour_of(surface);
    for (Rgb& c : grey.pixels()) c = Rgb(0.25f + 0.7f * luminance(c));
    return grey;
}

void tint(Rgb& pixel, const Rgb& colour, float part) { pixel += 0.75f * part * (colour - pixel); }

// A line of text that ends within the picture.
void write_text(Image<Rgb>& picture, const std::string& text, int x, int y, double height_px) {
    cv::Mat canvas = view_of(picture);
    int base = 0;
    const int width = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, height_px / 22, 1, &base).width;
    const double fits = std::min(1.0, static_cast<double>(picture.width() - x - 4) / std::max(width, 1));
    cv::putText(canvas, text, {x, y}, cv::FONT_HERSHEY_SIMPLEX, fits * height_px / 22,
                cv::Scalar(0.1, 0.1, 0.1), std::max(1, static_cast<int>(height_px / 14)), cv::LINE_AA);
}

}  // namespace

Image<Rgb> reduced(const Image<Rgb>& picture, int most_wide, int most_high) {
    double factor = 1;
    if (most_wide > 0) factor = std::min(factor, static_cast<double>(most_wide) / picture.width());
    if (most_high > 0) factor = std::min(factor, static_cast<double>(most_high) / picture.height());
    if (factor >= 1) return picture;
    Image<Rgb> small(std::max(static_cast<int>(std::lround(picture.width() * factor)), 1),
                     std::max(static_cast<int>(std::lround(picture.height() * factor)), 1));
    cv::Mat target = view_of(small);
    cv::resize(view_of(picture), target, target.size(), 0, 0, cv::INTER_AREA);
    return small;
}

Image<Rgb> colour_of(const Surface& surface, int side_px) {
    Image<Rgb> picture = reduced(surface.diffuse, side_px, side_px);
    encode(picture, 1);
    return picture;
}

Image<Rgb> encoded(Image<Rgb> diffuse) {
    encode(diffuse, 1);
    return diffuse;
}

Image<Rgb> look_of(const Surface& surface, const Light& light, int side_px, const Progress& progress) {
    Image<Rgb> picture = reduced(relight(surface, std::span(&light, 1), {}, progress), side_px, side_px);
    encode(picture, std::sqrt(2.0f));
    return picture;
}

Image<Rgb> damage_map(const Treatment& treatment, const Surface& surface, const MasksToCome& to_come) {
    Image<Rgb> picture = in_grey(surface);
    for (const DamageClass damage : kDamageClasses) {
        const std::optional<Mask> mask = mask_with(to_come, treatment, damage);
        for (std::size_t i = 0; mask && i < mask->size(); ++i)
            tint(picture.pixels()[i], legend_colour_srgb(damage), mask->pixels()[i]);
    }
    return picture;
}

Image<Rgb> damage_picture(const Treatment& treatment, const Surface& surface, const MasksToCome& to_come) {
    const Image<Rgb> map = damage_map(treatment, surface, to_come);
    const int width = map.width(), height = map.height();
    const nlohmann::json table = damage_table(treatment, to_come);
    const int line = std::max(width / 30, 12);
    const int rows = std::max(static_cast<int>(table.size()), 1);
    Image<Rgb> picture(width, height + line * (rows + 1), Rgb(1));
    for (int y = 0; y < height; ++y) std::copy(map.row(y).begin(), map.row(y).end(), picture.row(y).begin());
    int row = 0;
    for (const auto& entry : table) {
        const auto damage = *damage_class_named(entry.at("class").get<std::string>());
        const Rgb colour = legend_colour_srgb(damage);
        const int top = height + line / 2 + row * line;
        for (int y = top; y < top + line * 7 / 10; ++y)
            for (int x = line / 2; x < line * 3 / 2 && x < width; ++x) picture(x, y) = colour;
        std::string name(name_of(damage));
        std::replace(name.begin(), name.end(), '_', ' ');
        const std::string stated = area_in_words(entry), square = "²";
        const std::size_t at = stated.find(square);
        const std::string area =  // OpenCV's letters are ASCII
            at == std::string::npos ? stated : stated.substr(0, at) + "2" + stated.substr(at + square.size());
        write_text(picture,
                   fmt::format("{}: {} x, {}, {:.2f} %", name, entry.at("count").get<int>(), area,
                               entry.at("percent").get<double>()),
                   line * 2, top + line * 6 / 10, line * 0.6);
        ++row;
    }
    if (table.empty()) write_text(picture, "no damage is mapped", line / 2, height + line, line * 0.6);
    return picture;
}

Image<Rgb> additions_picture(const Canvas& canvas, const std::vector<TreatmentLayer>& layers,
                             const Mask& belongs) {
    constexpr Rgb fill(0, 0.62f, 0.45f), varnish(0.94f, 0.89f, 0.26f), retouch(0, 0.45f, 0.7f),
        beside(0.84f, 0.1f, 0.1f);
    // What counts most is seen: retouches, then fills, then varnish.
    Mask filled(canvas.width(), canvas.height()), retouched = filled, varnished = filled;
    for (const DriedLayer& layer : canvas.dried()) {
        const auto about = std::find_if(layers.begin(), layers.end(),
                                        [&](const TreatmentLayer& l) { return l.name == layer.name; });
        const LayerRole role = about == layers.end() ? LayerRole::retouch : about->role;
        Mask& all = role == LayerRole::fill ? filled : role == LayerRole::retouch ? retouched : varnished;
        all = united(all, additions(layer.paint));
    }
    Image<Rgb> picture = in_grey(canvas.dry());
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x) {
            if (retouched(x, y) > 0)
                tint(picture(x, y), belongs(x, y) > 0 ? retouch : beside, 1);
            else if (filled(x, y) > 0)
                tint(picture(x, y), belongs(x, y) > 0 ? fill : beside, 1);
            else
                tint(picture(x, y), varnish, 0.4f * varnished(x, y));
        }
    return picture;
}

}  // namespace tangi
