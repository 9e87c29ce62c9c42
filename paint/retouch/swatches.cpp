#include "paint/retouch/swatches.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "surface/error.h"

namespace tangi {

namespace {

constexpr float kPaper = 0.35f, kInk = 0.02f;  // a grey surround, as for judging colours (ISO 3664)

void write(cv::Mat& ink, const std::string& text, double x, double y, double scale) {
    cv::putText(ink, text, cv::Point(static_cast<int>(x), static_cast<int>(y)), cv::FONT_HERSHEY_SIMPLEX,
                scale, cv::Scalar(255), 1, cv::LINE_AA);
}

}  // namespace

Image<Rgb> recipe_swatches(const Spectrum& target, std::span<const MatchedRecipe> recipes, int cell_px) {
    if (recipes.empty()) fail("swatches: there is no recipe to show");
    if (cell_px < 60 || cell_px > 1000)
        fail("swatches: cells of {} pixels are outside of [60, 1000]", cell_px);
    const int gap = cell_px / 8, label = cell_px / 2, text = cell_px / 5, swatch = cell_px * 5 / 8;
    const int width = label + static_cast<int>(recipes.size()) * (cell_px + gap) + gap;
    const int row = swatch + text + gap, height = kIlluminants * row + gap;
    Image<Rgb> picture(width, height, Rgb(kPaper));
    cv::Mat ink = cv::Mat::zeros(height, width, CV_8U);
    const double scale = cell_px / 320.0;
    for (int lamp = 0; lamp < kIlluminants; ++lamp) {
        const auto light = static_cast<Illuminant>(lamp);
        const int top = gap + lamp * row;
        write(ink, std::string(name_of(light)), gap, top + swatch / 2, scale);
        for (int i = 0; i < static_cast<int>(recipes.size()); ++i) {
            const MatchedRecipe& recipe = recipes[static_cast<std::size_t>(i)];
            const int left = label + gap + i * (cell_px + gap);
            const Rgb colours[] = {to_linear_rgb(target, light), to_linear_rgb(recipe.look, light)};
            for (int y = 0; y < swatch; ++y)
                for (int x = 0; x < cell_px; ++x)
                    picture(left + x, top + y) = glm::max(colours[x >= cell_px / 2], Rgb(0));
            write(ink, fmt::format("dE {:.2f}", recipe.delta_e[static_cast<std::size_t>(lamp)]), left,
                  top + swatch + text * 0.8, scale);
        }
    }
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float part = static_cast<float>(ink.at<unsigned char>(y, x)) / 255;
            picture(x, y) += part * (Rgb(kInk) - picture(x, y));
        }
    return picture;
}

}  // namespace tangi
