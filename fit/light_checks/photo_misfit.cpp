#include "fit/light_checks/photo_misfit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "fit/light_checks/misfit_terms.h"
#include "surface/base/median.h"
#include "surface/base/parallel.h"
#include "surface/maps/light.h"
#include "surface/render/relighter.h"

namespace tangi {

namespace {

constexpr int kRows = 24, kColumn = 12;  // [pixels] of a block: waves of the finest relief, many in a picture
constexpr double kPixels = 2e5;          // of the picture that are looked at, or more where it is very wide
constexpr int kFewestStripes = 4;        // of blocks, from top to bottom
constexpr float kUnlit = 0.01f;          // [1] of a matt white's light: less is none
constexpr float kGlossy = 2;             // [1] of the matt part: more is mostly lobe
constexpr std::size_t kSamples = 1u << 17;  // of places that no light reaches

// [pixels] Side of what must be unlit around a place: next to what is lit, a lens and resampling blur light
// in.
constexpr int kUnlitBox = 3;

// Rows of a stripe under one light, channels averaged.
struct StripePhoto {
    Image<float> predicted, measured, sigma;  // sigma: 0 where there is no matt pixel to compare
    Image<float> laplacian, blurred;          // of the prediction; by a box
    Image<float> unlit_part;                  // 1 where no light reaches
    std::vector<UnlitPlace> unlit;
    std::vector<float> glossy;  // [sigma] measured - predicted of pixels that are not matt

    StripePhoto(int width, int rows)
        : predicted(width, rows), measured(width, rows), sigma(width, rows), unlit_part(width, rows) {}
};

// [sigma] Robust deviations of one kind of pixels, and how many there are.
struct Deviations {
    std::vector<float> of_stripes;
    std::size_t pixels = 0;

    void add(std::vector<float> values) {
        if (values.empty()) return;
        pixels += values.size();
        for (float& value : values) value = std::abs(value);
        of_stripes.push_back(1.4826f * median(std::move(values)));
    }
};

float mean_of(const Rgb& colour, int channels) {
    return channels == 1 ? colour.g : (colour.r + colour.g + colour.b) / 3;
}

// Two unit vectors at right angles to a direction and to each other: a direction that is off is shaded by
// them, and must not pass for another cause.
std::array<Vec3, 2> across(const Vec3& direction) {
    const Vec3 other = std::abs(direction.z) < 0.9f ? Vec3(0, 0, 1) : Vec3(1, 0, 0);
    const Vec3 first = glm::normalize(glm::cross(direction, other));
    return {first, glm::cross(direction, first)};
}

float laplacian_at(const Image<float>& p, int x, int y) {
    return p(x - 1, y) + p(x + 1, y) + p(x, y - 1) + p(x, y + 1) - 4 * p(x, y);
}

// 0 at the border.
Image<float> laplacian_of(const Image<float>& picture) {
    Image<float> result(picture.width(), picture.height());
    for (int y = 1; y + 1 < picture.height(); ++y)
        for (int x = 1; x + 1 < picture.width(); ++x) result(x, y) = laplacian_at(picture, x, y);
    return result;
}

// Means of side x side pixels; 0 nearer to the border than half of that.
Image<float> mean_of_box(const Image<float>& picture, int side) {
    const int reach = side / 2, w = picture.width(), h = picture.height();
    const auto part = 1 / static_cast<float>(side);
    Image<float> across(w, h), mean(w, h);
    for (int y = 0; y < h; ++y)
        for (int x = reach; x + reach < w; ++x)
            for (int i = -reach; i <= reach; ++i) across(x, y) += part * picture(x + i, y);
    for (int y = reach; y + reach < h; ++y)
        for (int x = 0; x < w; ++x)
            for (int i = -reach; i <= reach; ++i) mean(x, y) += part * across(x, y + i);
    return mean;
}

class Comparison {
public:
    Comparison(const CalibratedStack& input, const Surface& surface, double model_error)
        : stack_(input.stack),
          noise_(input.noise),
          surface_(surface),
          lighting_(input.lighting),
          model_error_(model_error),
          relighter_(surface, {.cast_shadows = true}, static_cast<int>(lighting_.lights.size())),
          normals_(lighting_.lights.size()),
          unlit_(lighting_.lights.size()),
          brightness_(lighting_.lights.size()),
          matt_(lighting_.lights.size()),
          glossy_(lighting_.lights.size()) {}

    void add(const Band& band) {
        parallel_for(0, band.photos(), 1, [&](int begin, int end) {
            for (int i = begin; i < end; ++i) add_photo(band, i);
        });
        ++stripes_;
    }
    std::vector<std::vector<MisfitNormal>>& normals() { return normals_; }
    // [1] linear, of all photographs
    double middling() const {
        std::vector<float> all;
        for (const auto& photo : brightness_) all.insert(all.end(), photo.begin(), photo.end());
        return static_cast<double>(median(std::move(all)));
    }
    PhotoMisfits::Kind matt() const { return kind_of(matt_); }
    PhotoMisfits::Kind glossy() const { return kind_of(glossy_); }
    std::vector<UnlitPlace> unlit() const {
        std::vector<UnlitPlace> all;
        for (const auto& photo : unlit_) all.insert(all.end(), photo.begin(), photo.end());
        return all;
    }

private:
    PhotoMisfits::Kind kind_of(const std::vector<Deviations>& photos) const;
    void add_photo(const Band& band, int photo);
    bool is_glossy(int x, int y, float direct, float rho, const Vec3& light) const;
    void look_at_row(const Band& band, int photo, int y, StripePhoto& into) const;
    void add_block(const StripePhoto& stripe, int y0, int x0, float limit, float offset, int photo);

    const Stack& stack_;
    const NoiseModel& noise_;
    const Surface& surface_;
    const Lighting& lighting_;
    double model_error_;
    Relighter relighter_;
    std::vector<std::vector<MisfitNormal>> normals_;  // [photo][block]
    std::vector<std::vector<UnlitPlace>> unlit_;      // [photo]
    std::vector<std::vector<float>> brightness_;      // [photo][stripe] median of the matt pixels
    std::vector<Deviations> matt_, glossy_;           // [photo]
    int stripes_ = 0;
};

// What is metal, or shows mostly the lobe under this light. Lobes differ from the model by far more than matt
// paint does, and with them all that is looked for here would be found.
bool Comparison::is_glossy(int x, int y, float direct, float rho, const Vec3& light) const {
    if (surface_.specular(x, y) > mean_of(surface_.diffuse(x, y), stack_.channels)) return true;
    return direct > kGlossy * rho * std::max(glm::dot(surface_.normal(x, y), light), kUnlit);
}

// Of the middling photograph.
PhotoMisfits::Kind Comparison::kind_of(const std::vector<Deviations>& photos) const {
    std::vector<float> all;
    std::size_t pixels = 0, compared = 0;
    for (const Deviations& photo : photos)
        if (photo.pixels > 0) all.push_back(median(photo.of_stripes));
    for (const Deviations& photo : photos) pixels += photo.pixels;
    for (const auto* kind : {&matt_, &glossy_})
        for (const Deviations& photo : *kind) compared += photo.pixels;
    return {static_cast<double>(median(std::move(all))),
            compared > 0 ? static_cast<double>(pixels) / static_cast<double>(compared) : 0};
}

// Prediction and photograph of a row; collects what no light reaches.
void Comparison::look_at_row(const Band& band, int photo, int y, StripePhoto& into) const {
    const Light& light = lighting_.lights[static_cast<std::size_t>(photo)];
    const auto white = static_cast<float>(lighting_.white_level);
    std::vector<Rgb> row(static_cast<std::size_t>(band.width()), Rgb(0));
    relighter_.add_row(light, y, row);
    const int r = y - band.y0(), columns = std::max(band.width() / kColumn, 1);
    for (int x = 0; x < band.width(); ++x) {
        const Rgb predicted = white * row[static_cast<std::size_t>(x)];
        into.predicted(x, r) = mean_of(predicted, band.channels());
        into.sigma(x, r) = 0;
        if (!(surface_.confidence(x, y) > 0) || (!stack_.mask.empty() && !stack_.mask(x, y))) continue;
        float mean = 0, values[3] = {};
        bool known = true;
        for (int c = 0; c < band.channels(); ++c) {
            values[c] = band.row(photo, c, y)[x];
            known = known && noise_.sigma(values[c]) > 0;
            mean += values[c] / static_cast<float>(band.channels());
        }
        if (!known) continue;
        const auto sigma = static_cast<float>(
            std::hypot(noise_.sigma(mean), model_error_ * static_cast<double>(std::max(mean, 0.0f))));
        const Incidence in = incidence(light, surface_.point_mm(x, y), surface_.photography.rig);
        const Rgb rho = in.irradiance * surface_.diffuse(x, y) * white;
        const Rgb direct = predicted - surface_.photography.rig.ambient * rho;
        if (is_glossy(x, y, mean_of(direct, band.channels()), mean_of(rho, band.channels()), in.direction)) {
            into.glossy.push_back((mean - into.predicted(x, r)) / sigma);
            continue;
        }
        into.measured(x, r) = mean;
        into.sigma(x, r) = sigma;
        if (!(mean_of(direct, band.channels()) < kUnlit * mean_of(rho, band.channels()))) continue;
        const int block = stripes_ * columns + std::min(x / kColumn, columns - 1);
        into.unlit_part(x, r) = 1;
        for (int c = 0; c < band.channels(); ++c) into.unlit.push_back({rho[c], values[c], x, r, block});
    }
}

void Comparison::add_block(const StripePhoto& stripe, int y0, int x0, float limit, float offset, int photo) {
    MisfitNormal& block = normals_[static_cast<std::size_t>(photo)].emplace_back();
    const Image<float>& p = stripe.predicted;
    constexpr int kMargin = kMisfitBox / 2;
    const std::array<Vec3, 2> aside = across(lighting_.lights[static_cast<std::size_t>(photo)].direction);
    for (int r = kMargin; r + kMargin < p.height(); ++r)
        for (int x = std::max(x0, kMargin); x < std::min(x0 + kColumn, p.width() - kMargin); ++x) {
            const float sigma = stripe.sigma(x, r), residual = stripe.measured(x, r) - p(x, r);
            if (!(sigma > 0) || !(std::abs(residual / sigma - offset) < limit)) continue;
            const float rho = mean_of(surface_.diffuse(x, y0 + r), stack_.channels);
            const double white_rho = lighting_.white_level * static_cast<double>(rho);
            const Vec3& normal = surface_.normal(x, y0 + r);
            const double lit = static_cast<double>(p(x, r)) > 2 * kUnlit * white_rho ? white_rho : 0;
            const glm::dvec2 from_middle(2.0 * x / surface_.width() - 1,
                                         2.0 * (y0 + r) / surface_.height() - 1);
            MisfitTerms terms;
            terms << p(x, r), white_rho, 1, lit * static_cast<double>(glm::dot(normal, aside[0])),
                lit * static_cast<double>(glm::dot(normal, aside[1])), from_middle.x * p(x, r),
                from_middle.y * p(x, r), static_cast<double>(laplacian_at(stripe.laplacian, x, r)),
                static_cast<double>(stripe.laplacian(x, r)) / 2,
                static_cast<double>(stripe.blurred(x, r) - p(x, r));
            terms /= static_cast<double>(sigma);
            const double left = static_cast<double>(residual / sigma);
            block.matrix += terms * terms.transpose();
            block.right += terms * left;
            block.squares += left * left;
            ++block.count;
        }
}

void Comparison::add_photo(const Band& band, int photo) {
    const int rows = band.y1() - band.y0();
    StripePhoto stripe(band.width(), rows);
    for (int y = band.y0(); y < band.y1(); ++y) look_at_row(band, photo, y, stripe);
    stripe.laplacian = laplacian_of(stripe.predicted);
    stripe.blurred = mean_of_box(stripe.predicted, kMisfitBox);
    const Image<float> unlit_around = mean_of_box(stripe.unlit_part, kUnlitBox);
    std::erase_if(stripe.unlit,
                  [&](const UnlitPlace& place) { return unlit_around(place.x, place.row) < 0.999f; });
    std::vector<float> off, values;
    for (std::size_t i = 0; i < stripe.sigma.size(); ++i) {
        const float sigma = stripe.sigma.pixels()[i];
        if (!(sigma > 0)) continue;
        values.push_back(stripe.measured.pixels()[i]);
        off.push_back((values.back() - stripe.predicted.pixels()[i]) / sigma);
    }
    const auto index = static_cast<std::size_t>(photo);
    matt_[index].add(off);
    glossy_[index].add(std::move(stripe.glossy));
    if (!values.empty()) brightness_[index].push_back(median(std::move(values)));
    const float middle = median(off);
    for (float& value : off) value = std::abs(value - middle);
    const float limit = static_cast<float>(kMisfitOutlier * 1.4826) * median(std::move(off));
    for (int x0 = 0; x0 + kColumn <= band.width(); x0 += kColumn)
        add_block(stripe, band.y0(), x0, limit, middle, photo);
    auto& unlit = unlit_[index];
    const std::size_t room = kSamples / lighting_.lights.size();
    const std::size_t step = stripe.unlit.size() / std::max<std::size_t>(room, 1) + 1;
    for (std::size_t i = 0; i < stripe.unlit.size(); i += step) unlit.push_back(stripe.unlit[i]);
}

}  // namespace

PhotoMisfits photo_misfits(const CalibratedStack& input, const Surface& surface, double model_error,
                           const Progress& progress) {
    const Stack& stack = input.stack;
    const std::vector<Light>& lights = input.lighting.lights;
    PhotoMisfits misfits;
    const int height = stack.height(), rows = std::min(kRows + kMisfitBox - 1, height);
    if (rows < kMisfitBox || stack.width() < kMisfitBox) return misfits;
    const double row_pixels = static_cast<double>(stack.width()) * rows;
    const int stripes = std::min(std::max(static_cast<int>(kPixels / row_pixels), kFewestStripes),
                                 std::max(height / rows, 1));
    Comparison comparison(input, surface, model_error);
    StackReader reader(stack);
    for (int k = 0; k < stripes; ++k) {
        // In the middles of parts that are as high.
        const int y0 = std::max(static_cast<int>(height * (k + 0.5) / stripes - rows / 2.0), 0);
        comparison.add(reader.read(y0, y0 + rows, input.transfer));
        report(progress, "causes of misfit", (k + 1) / static_cast<double>(stripes));
    }
    const std::vector<PhotoTerms> terms = solve_photos(comparison.normals());
    misfits.photos = relative_misfits(terms);
    misfits.judged = static_cast<int>(
        std::count_if(terms.begin(), terms.end(), [](const PhotoTerms& photo) { return photo.solved; }));
    std::vector<double> strengths;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        PhotoMisfit& misfit = misfits.photos[i];
        misfit.strength = static_cast<double>(lights[i].gain.g) * (1 + misfit.gain.value);
        strengths.push_back(misfit.strength);
    }
    misfits.matt = comparison.matt();
    misfits.glossy = comparison.glossy();
    misfits.veil = veil_of(comparison.unlit(), comparison.middling());
    const double middling = median(strengths);
    for (PhotoMisfit& misfit : misfits.photos) misfit.strength /= middling > 0 ? middling : 1;
    return misfits;
}

}  // namespace tangi
