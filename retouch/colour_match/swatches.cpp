#include "retouch/colour_match/swatches.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "retouch/colour_match/mixing_steps.h"
#include "surface/base/error.h"

namespace tangi {

namespace {

constexpr float kPaper = 0.35f, kSwatchInk = 0.02f;  // a grey surround, as for judging colours (ISO 3664)

void write(cv::Mat& ink, const std::string& text, double x, double y, double scale) {
    cv::putText(ink, text, cv::Point(static_cast<int>(x), static_cast<int>(y)), cv::FONT_HERSHEY_SIMPLEX,
                scale, cv::Scalar(255), 1, cv::LINE_AA);
}

// Lines of at most so many characters, broken at spaces; those after the first are indented. The font has no
// other letters than ASCII's.
std::vector<std::string> wrapped(const std::string& text, std::size_t most) {
    std::vector<std::string> lines(1);
    std::istringstream words(text);
    for (std::string word; words >> word;) {
        for (char& c : word)
            if (static_cast<unsigned char>(c) > '~') c = '?';
        std::string& line = lines.back();
        if (!line.empty() && line.size() + 1 + word.size() > most)
            lines.push_back("   " + word);
        else
            line += (line.empty() ? "" : " ") + word;
    }
    return lines;
}

}  // namespace

Image<Rgb> recipe_swatches(const Spectrum& target, std::span<const MatchedRecipe> recipes,
                           const std::vector<Pigment>& paints, int cell_px) {
    if (recipes.empty()) fail("swatches: there is no recipe to show");
    if (cell_px < 60 || cell_px > 1000)
        fail("swatches: cells of {} pixels are outside of [60, 1000]", cell_px);
    const int gap = cell_px / 8, label = cell_px / 2, text = cell_px / 5, swatch = cell_px * 5 / 8;
    const int width = label + static_cast<int>(recipes.size()) * (cell_px + gap) + gap;
    const int row = swatch + text + gap, head = text, line = cell_px / 6,
              table = head + kIlluminants * row + gap;
    const double scale = cell_px / 320.0;
    const int letter = std::max(cv::getTextSize("m", cv::FONT_HERSHEY_SIMPLEX, scale, 1, nullptr).width, 1);
    std::vector<std::string> lines;
    for (std::size_t i = 0; i < recipes.size(); ++i)
        for (std::string& more :
             wrapped(fmt::format("{}: {}", i + 1, text_of(recipes[i].steps, paints)),
                     static_cast<std::size_t>(std::max((width - 2 * gap) / letter * 9 / 5, 20))))
            lines.push_back(std::move(more));
    const int height = table + static_cast<int>(lines.size()) * line + gap;
    Image<Rgb> picture(width, height, Rgb(kPaper));
    cv::Mat ink = cv::Mat::zeros(height, width, CV_8U);
    for (std::size_t i = 0; i < lines.size(); ++i)
        write(ink, lines[i], gap, table + (static_cast<double>(i) + 0.8) * line, scale);
    for (int i = 0; i < static_cast<int>(recipes.size()); ++i)
        write(ink, fmt::format("target | {}", i + 1), label + gap + i * (cell_px + gap), 0.9 * head, scale);
    for (int illuminant = 0; illuminant < kIlluminants; ++illuminant) {
        const auto light = static_cast<Illuminant>(illuminant);
        const int top = head + gap / 2 + illuminant * row;
        write(ink, std::string(name_of(light)), gap, top + swatch / 2, scale);
        for (int i = 0; i < static_cast<int>(recipes.size()); ++i) {
            const MatchedRecipe& recipe = recipes[static_cast<std::size_t>(i)];
            const int left = label + gap + i * (cell_px + gap);
            const Rgb colours[] = {to_linear_rgb(target, light), to_linear_rgb(recipe.look, light)};
            for (int y = 0; y < swatch; ++y)
                for (int x = 0; x < cell_px; ++x)
                    picture(left + x, top + y) = glm::max(colours[x >= cell_px / 2], Rgb(0));
            write(ink, fmt::format("dE {:.2f}", recipe.delta_e[static_cast<std::size_t>(illuminant)]), left,
                  top + swatch + text * 0.8, scale);
        }
    }
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float part = static_cast<float>(ink.at<unsigned char>(y, x)) / 255;
            picture(x, y) += part * (Rgb(kSwatchInk) - picture(x, y));
        }
    return picture;
}

}  // namespace tangi
