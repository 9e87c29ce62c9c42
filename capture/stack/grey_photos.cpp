#include "capture/stack/grey_photos.h"

#include <algorithm>
#include <cmath>

#include "capture/photo/photo_file.h"
#include "capture/photo/photo_folder.h"
#include "capture/photo/photo_format.h"
#include "surface/base/error.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

float mean_of_channels(const float* value, int channels) {
    return channels == 1 ? value[0] : (value[0] + value[1] + value[2]) / 3;
}

void read_reduced(PhotoSet::Reader& file, int reduction, Image<float>& mean, Image<float>* brightest) {
    const PhotoHeader& header = file.header();
    const int rows = std::max(1, 64 / reduction) * reduction;
    const auto row = static_cast<std::size_t>(header.width) * static_cast<std::size_t>(header.channels);
    std::vector<float> values(row * static_cast<std::size_t>(rows));
    const float share = 1.0f / static_cast<float>(reduction * reduction);
    for (int y0 = 0; y0 < mean.height() * reduction; y0 += rows) {
        const int y1 = std::min(y0 + rows, mean.height() * reduction);
        file.read_rows(y0, y1, values);
        for (int y = y0; y < y1; ++y)
            for (int x = 0; x < mean.width() * reduction; ++x) {
                const float* value =
                    &values[row * static_cast<std::size_t>(y - y0) +
                            static_cast<std::size_t>(x) * static_cast<std::size_t>(header.channels)];
                const float grey = mean_of_channels(value, header.channels);
                mean(x / reduction, y / reduction) += std::isfinite(grey) ? share * grey : 0;
                if (brightest) {
                    float& most = (*brightest)(x / reduction, y / reduction);
                    most = std::max(most, grey);
                }
            }
    }
}

}  // namespace

GreyPhotos read_grey_photos(const PhotoSet& set, const Progress& progress, std::size_t most_values) {
    GreyPhotos photos;
    std::vector<PhotoSet::Reader> files;
    for (std::size_t i = 0; i < set.size(); ++i) {
        files.emplace_back(set, i);
        const PhotoHeader& header = files.back().header();
        if (files.size() == 1) {
            photos.width = header.width;
            photos.height = header.height;
            photos.step = set.developed() || header.is_float
                              ? 1e-4f
                              : 1.0f / static_cast<float>((1 << header.bits) - 1);
        }
        if (header.width != photos.width || header.height != photos.height)
            fail("{}: is {} x {}, but {} is {} x {}; all photographs of a stack must have the same size",
                 set.path(i).string(), header.width, header.height, set.path(0).filename().string(),
                 photos.width, photos.height);
    }
    const double values = static_cast<double>(photos.width) * photos.height * static_cast<double>(set.size());
    photos.reduction =
        std::max(1, static_cast<int>(std::ceil(std::sqrt(values / static_cast<double>(most_values)))));
    const int width = photos.width / photos.reduction, height = photos.height / photos.reduction;
    if (width < 1 || height < 1) fail("{}: is too small", set.path(0).string());
    photos.mean.assign(set.size(), Image<float>(width, height));
    if (photos.reduction > 1) photos.brightest.assign(set.size(), Image<float>(width, height));
    const int count = static_cast<int>(set.size()), batch = std::max(2, thread_count());
    for (int first = 0; first < count; first += batch) {
        report(progress, "read", first / static_cast<double>(count));
        parallel_for(first, std::min(first + batch, count), 1, [&](int begin, int end) {
            for (int i = begin; i < end; ++i) {
                const auto photo = static_cast<std::size_t>(i);
                read_reduced(files[photo], photos.reduction, photos.mean[photo],
                             photos.reduction > 1 ? &photos.brightest[photo] : nullptr);
            }
        });
    }
    report(progress, "read", 1);
    return photos;
}

Image<float> read_grey_region(const PhotoSet& set, std::size_t photo, const Region& region) {
    PhotoSet::Reader file = set.open(photo);
    const PhotoHeader& header = file.header();
    TP_REQUIRE(region.x0 >= 0 && region.y0 >= 0 && region.x1 <= header.width && region.y1 <= header.height,
               "the region lies in the photograph");
    Image<float> grey(region.width(), region.height());
    const auto channels = static_cast<std::size_t>(header.channels);
    std::vector<float> values(static_cast<std::size_t>(header.width) * channels);
    for (int y = region.y0; y < region.y1; ++y) {
        file.read_rows(y, y + 1, values);
        for (int x = region.x0; x < region.x1; ++x) {
            const float value =
                mean_of_channels(&values[static_cast<std::size_t>(x) * channels], header.channels);
            grey(x - region.x0, y - region.y0) = std::isfinite(value) ? value : 0;
        }
    }
    return grey;
}

std::vector<fs::path> pictures_in(const fs::path& folder, std::vector<std::string>& warnings) {
    require_folder(folder);
    std::vector<fs::path> pictures = photos_in(folder);
    for (const fs::path& mask : take_masks(pictures))
        warnings.push_back(fmt::format("{}: rejected, since its name says that it is a mask", mask.string()));
    if (pictures.empty())
        fail("{}: no photographs ({}) in this folder", folder.string(), photo_formats_in_words());
    return pictures;
}

}  // namespace tangi
