#include "capture/stack/photo_source.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "capture/photo/exposure_merge.h"
#include "capture/stack/photo_profiles.h"
#include "capture/stack/survey.h"
#include "surface/base/error.h"

namespace tangi {

namespace {

// Rows of a frame, or nothing where there is none.
void read_frame(const std::shared_ptr<const Frame>& frame, int y0, std::size_t count,
                std::vector<float>& rows) {
    rows.resize(frame ? count : 0);
    if (frame) frame->read(0, y0, rows);
}

// Camera colour to another one. A colour of which a channel is clipped is not known in any channel.
void convert(const Development& d, float* pixel) {
    const glm::vec3 v(pixel[0], pixel[1], pixel[2]);
    if (std::max({v.x, v.y, v.z}) >= d.sensor_clipped) {
        pixel[0] = pixel[1] = pixel[2] = d.clipped;
        return;
    }
    const glm::vec3 c = *d.colour * v;
    const float below = std::nextafter(d.clipped, 0.0f);
    for (int i = 0; i < 3; ++i) pixel[i] = std::isnan(c[i]) ? c[i] : std::clamp(c[i], 0.0f, below);
}

}  // namespace

float Development::decode(float stored) const {
    if (table.empty()) return encoding.decode(stored);
    return table[static_cast<std::size_t>(stored * static_cast<float>(table.size() - 1) + 0.5f)];
}

PhotoSource::PhotoSource(const Stack& stack, const StackPhoto& photo) : stack_(stack) {
    const Development* development = stack.development.get();
    const std::string demosaic = development ? development->demosaic : stack.develop.demosaic;
    const auto add = [&](const std::filesystem::path& path, double relative) {
        files_.emplace_back(path, demosaic);
        profiles_.push_back(conversion_of(stack, path));
        relative_.push_back(static_cast<float>(relative));
        const bool kept = development && development->raw_index.contains(path);
        raws_.push_back(kept ? development->raw_index.at(path) : -1);
    };
    if (!development || photo.exposures.empty())
        add(photo.path, 1);
    else
        for (const Exposure& exposure : photo.exposures) add(exposure.path, exposure.relative);
    header_ = files_.front().header();
    if (stack.float_codes) header_.is_float = false, header_.bits = 16;
}

long PhotoSource::without_number() const {
    long pixels = 0;
    for (const PhotoFile& file : files_) pixels += file.without_number();
    return pixels;
}

long PhotoSource::transparent() const {
    long pixels = 0;
    for (const PhotoFile& file : files_) pixels += file.transparent();
    return pixels;
}

void PhotoSource::read_stored(std::size_t exposure, int y0, int y1, std::span<float> values) {
    if (raws_[exposure] < 0) {
        files_[exposure].read_rows(y0, y1, values);
        const auto row =
            static_cast<std::size_t>(header().width) * static_cast<std::size_t>(header().channels);
        const std::span<float> read = values.first(row * static_cast<std::size_t>(y1 - y0));
        if (stack_.full_scale != 1 || stack_.float_codes)
            divide_by_full_scale(read, stack_.full_scale, !header().is_float);
        if (profiles_[exposure]) profiles_[exposure]->convert(read);
        return;
    }
    codes_.resize(values.size());
    stack_.development->raws->read(raws_[exposure], y0, codes_);
    std::transform(codes_.begin(), codes_.end(), values.begin(),
                   [](std::uint16_t code) { return static_cast<float>(code) / 65535; });
}

void PhotoSource::read_rows(int y0, int y1, std::span<float> values) {
    if (!stack_.development) return read_stored(0, y0, y1, values);
    const Development& d = *stack_.development;
    const std::size_t exposures = files_.size();
    const std::size_t count = static_cast<std::size_t>(header().width) *
                              static_cast<std::size_t>(header().channels) * static_cast<std::size_t>(y1 - y0);
    stored_.resize(count * exposures);
    for (std::size_t k = 0; k < exposures; ++k)
        read_stored(k, y0, y1, std::span(stored_).subspan(k * count, count));
    read_frame(d.dark, y0, count, dark_);
    read_frame(d.ambient, y0, count, ambient_);
    read_frame(d.gain, y0, count, gain_);
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    const float stored_clipped = d.table.empty() ? std::numeric_limits<float>::infinity() : kClipped;
    const float below = std::nextafter(d.sensor_clipped, 0.0f);
    std::vector<float> linear(exposures);
    for (std::size_t i = 0; i < count; ++i) {
        const float dark = dark_.empty() ? 0 : dark_[i];
        bool missing = false;
        for (std::size_t k = 0; k < exposures; ++k) {
            const float stored = stored_[k * count + i];
            missing = missing || std::isnan(stored) || std::isnan(dark);
            linear[k] = std::isnan(stored) || stored >= stored_clipped ? nan : d.decode(stored) - dark;
        }
        float value = exposures == 1 ? linear[0] / relative_[0] : merge_exposures(linear, relative_);
        if (std::isnan(value)) {
            values[i] = missing ? nan : d.sensor_clipped;
            continue;
        }
        if (!ambient_.empty()) value -= ambient_[i];
        if (!gain_.empty()) value *= gain_[i];
        values[i] = std::isnan(value) ? value : std::clamp(value, 0.0f, below);
    }
    if (d.colour)
        for (std::size_t i = 0; i < count; i += 3) convert(d, &values[i]);
}

}  // namespace tangi
