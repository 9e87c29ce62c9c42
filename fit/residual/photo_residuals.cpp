#include "fit/residual/photo_residuals.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/matrix.hpp>

#include "capture/stack/survey.h"
#include "surface/base/parallel.h"

namespace tangi {

using residual_kernel::Colours;
using residual_kernel::Sampled;

namespace {

constexpr int kBandRows = 256;

}  // namespace

std::vector<FittedPhoto> fitted_photos(const Surface& surface, const Stack& stack) {
    std::vector<FittedPhoto> photos;
    for (const StackPhoto& photo : stack.photos) {
        const Photography::Photo* known = find_photo(surface.photography, photo.light);
        if (!known || !known->fitted) continue;
        photos.push_back({stack, as_photographed(photo.light, surface.photography)});
        Stack& one = photos.back().stack;
        one.held_out.clear();
        one.photos = {photo};
        one.photos.front().homography = known->homography;
    }
    std::sort(photos.begin(), photos.end(), [](const FittedPhoto& a, const FittedPhoto& b) {
        return a.stack.photos.front().path < b.stack.photos.front().path;
    });
    return photos;
}

Colours colours_of(const Surface& surface, const Stack& stack) {
    const Photography& p = surface.photography;
    Colours colours;
    colours.to_photo = static_cast<float>(p.white_level) * glm::mat3(p.to_camera.value_or(glm::dmat3(1)));
    colours.from_photo = glm::inverse(colours.to_photo);
    colours.transfer = p.transfer;
    if (stack.development) {
        colours.clipped = stack.development->clipped;
    } else if (stack.bits != 32) {
        colours.clipped = p.transfer.decode(kClipped);
    }
    return colours;
}

Vec3 Residuals::of_pixel(const Light& light, int x, int y, const Rgb& value, const Rgb& predicted) const {
    Rgb left = value - predicted;
    for (int c = 0; c < 3; ++c)
        if (value[c] >= colours_.clipped) left[c] = std::max(left[c], 0.0f);
    const Rgb irradiance = incidence(light, surface_.point_mm(x, y), surface_.photography.rig).irradiance;
    return glm::transpose(colour_frame(surface_.diffuse(x, y))) * (colours_.from_photo * left / irradiance);
}

void Residuals::take_row(const FittedPhoto& photo, const Band& band, int row,
                         std::span<BlockResidual> residuals, Sampled* sampled) const {
    const int y = blocks_.middle(0, row).y;
    std::vector<Rgb> relit(static_cast<std::size_t>(surface_.width()));
    relighter_.draw_row(photo.light, y, relit);
    for (Rgb& value : relit) value = colours_.to_photo * value;
    const auto taken = [&](int x) {  // grey becomes RGB
        const auto channel = [&](int c) { return band.row(0, std::min(c, band.channels() - 1), y)[x]; };
        return Rgb(channel(0), channel(1), channel(2));
    };
    for (int block = 0, x = 0; block < blocks_.width; ++block) {
        Vec3 sum(0);
        float count = 0;
        for (; x < blocks_.end(block); ++x) {
            const Rgb value = taken(x);
            if (!(surface_.confidence(x, y) > 0) || std::isnan(value.r + value.g + value.b)) continue;
            sum += of_pixel(photo.light, x, y, value, relit[static_cast<std::size_t>(x)]);
            ++count;
        }
        residuals[static_cast<std::size_t>(block)] = BlockResidual(count > 0 ? sum / count : Vec3(0));
    }
    if (!sampled) return;
    const auto first = std::ranges::lower_bound(samples_, row, {}, [](const glm::ivec2& s) { return s.y; });
    for (auto s = first; s != samples_.end() && s->y == row; ++s) {
        const int at = blocks_.middle(s->x, row).x;
        const auto j = static_cast<std::size_t>(s - samples_.begin());
        sampled->stored[j] = taken(at);
        for (int c = 0; c < 3; ++c)
            if (float& v = sampled->stored[j][c]; !std::isnan(v))
                v = colours_.transfer.encode(std::min(v, 1.0f));
        sampled->relit[j] = relit[static_cast<std::size_t>(at)];
        sampled->irradiance[j] =
            incidence(photo.light, surface_.point_mm(at, y), surface_.photography.rig).irradiance;
    }
}

Image<BlockResidual> Residuals::of(const FittedPhoto& photo, Sampled* sampled) const {
    if (sampled)
        for (auto* values : {&sampled->stored, &sampled->relit, &sampled->irradiance})
            values->resize(samples_.size());
    StackReader reader(photo.stack);
    Image<BlockResidual> residuals(blocks_.width, blocks_.height);
    const int rows = std::max(kBandRows / blocks_.side, 1);  // of blocks, in a band
    for (int from = 0; from < blocks_.height; from += rows) {
        const int to = std::min(from + rows, blocks_.height);
        const Band band = reader.read(from * blocks_.side, std::min(to * blocks_.side, surface_.height()),
                                      photo.stack.development ? Transfer{} : colours_.transfer);
        parallel_for(from, to, 8, [&](int begin, int end) {
            for (int row = begin; row < end; ++row) take_row(photo, band, row, residuals.row(row), sampled);
        });
    }
    return residuals;
}

}  // namespace tangi
