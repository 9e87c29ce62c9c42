#include "capture/stack/photo_set.h"

#include <algorithm>
#include <cmath>

#include "capture/stack/photo_profiles.h"
#include "surface/base/error.h"

namespace tangi {

PhotoSet::PhotoSet(const std::vector<std::filesystem::path>& paths) {
    TP_REQUIRE(!paths.empty(), "there are photographs");
    for (const std::filesystem::path& path : paths)
        stack_.photos.push_back({path,
                                 distant_light({0, 0, 1}, path.filename().string()),
                                 static_cast<int>(stack_.photos.size()),
                                 {},
                                 {}});
}

PhotoMetadata PhotoSet::metadata(std::size_t photo) const { return metadata_in(stack_, path(photo)); }

void PhotoSet::Reader::read_rows(int y0, int y1, std::span<float> values) {
    source_.read_rows(y0, y1, values);
    const Development* d = set_.stack_.development.get();
    const std::size_t count = static_cast<std::size_t>(y1 - y0) * static_cast<std::size_t>(header().width) *
                              static_cast<std::size_t>(header().channels);
    // Of integers, only colours that are partly clipped have no sample (photo_profiles.h).
    if (!d && !header().is_float)
        for (float& value : values.first(count))
            if (std::isnan(value)) value = 1;
    if (!d || !std::isfinite(d->clipped)) return;
    // What the flat field tells nothing about is as unknown as what is clipped.
    for (float& value : values.first(count)) value = std::isnan(value) ? 1.0f : value / d->clipped;
}

Image<Rgb> PhotoSet::Reader::linear_rows(int y0, int y1, const Transfer& transfer) {
    const bool is_linear = set_.developed() || header().is_raw || header().is_float;
    const auto channels = static_cast<std::size_t>(header().channels);
    Image<Rgb> rows(header().width, y1 - y0);
    std::vector<float> values(rows.size() * channels);
    read_rows(y0, y1, values);
    const float* value = values.data();
    for (Rgb& pixel : rows.pixels()) {
        for (std::size_t c = 0; c < 3; ++c) {
            const float stored = value[std::min(c, channels - 1)];
            pixel[static_cast<int>(c)] = is_linear ? stored : transfer.decode(stored);
        }
        value += channels;
    }
    return rows;
}

Image<Rgb> PhotoSet::linear(std::size_t photo, const Transfer& transfer) const {
    constexpr int kRows = 256;
    Reader reader = open(photo);
    Image<Rgb> picture(reader.header().width, reader.header().height);
    for (int y0 = 0; y0 < picture.height(); y0 += kRows) {
        const Image<Rgb> rows = reader.linear_rows(y0, std::min(y0 + kRows, picture.height()), transfer);
        std::copy(rows.pixels().begin(), rows.pixels().end(), &picture(0, y0));
    }
    return picture;
}

std::vector<std::size_t> PhotoSet::brightest_first(const std::string& what, const Progress& progress) const {
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t photo = 0; photo < size(); ++photo) {
        report(progress, what, static_cast<double>(photo) / static_cast<double>(size()));
        const Image<Rgb> picture = linear(photo, Transfer{});
        double sum = 0;
        for (const Rgb& pixel : picture.pixels()) sum += std::isfinite(pixel.g) ? pixel.g : 0;
        order.emplace_back(-sum / static_cast<double>(picture.size()), photo);
    }
    std::sort(order.begin(), order.end());
    std::vector<std::size_t> sorted;
    for (const auto& [dark, photo] : order) sorted.push_back(photo);
    return sorted;
}

}  // namespace tangi
