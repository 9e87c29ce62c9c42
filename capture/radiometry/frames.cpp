#include "capture/radiometry/frames.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "capture/photo/photo_file.h"
#include "capture/stack/survey.h"
#include "surface/base/error.h"
#include "surface/file/visible_files.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr int kRows = 64;              // at a time
constexpr double kDarkestFlat = 0.1;   // [1] of the mean: below, noise and stray light rule
constexpr double kDarkestMean = 1e-4;  // [1] of full scale, which floats have not
constexpr double kMostClipped = 0.01, kMostUnusable = 0.05;

std::vector<fs::path> files_of(const fs::path& path, const std::string& role) {
    if (!fs::exists(path))
        fail("{}: no such {}: neither a picture nor a folder of pictures", path.string(), role);
    if (!fs::is_directory(path)) return {path};
    std::vector<fs::path> files;
    for (const fs::path& file : visible_files(path))
        if (is_photo_name(file)) files.push_back(file);
    if (files.empty()) fail("{}: no picture in this folder to be a {}", path.string(), role);
    return files;
}

void require_alike(const PhotoFile& file, const std::string& role, const FrameContext& context) {
    const PhotoHeader &header = file.header(), &like = context.like;
    if (header.width != like.width || header.height != like.height)
        fail(
            "{}: the {} is {} x {}, the photographs ({}) are {} x {}; take it with the same camera settings, "
            "not cropped or reduced",
            file.path().string(), role, header.width, header.height, context.like_path.filename().string(),
            like.width, like.height);
    if (header.channels != like.channels)
        fail("{}: the {} is {}, the photographs ({}) are {}; store them alike", file.path().string(), role,
             header.channels == 1 ? "grey" : "colour", context.like_path.filename().string(),
             like.channels == 1 ? "grey" : "colour");
    if (header.is_raw != like.is_raw)
        fail("{}: the {} is {}camera raw, the photographs ({}) are {}; store them alike",
             file.path().string(), role, header.is_raw ? "" : "no ", context.like_path.filename().string(),
             header.is_raw ? "not" : "raw");
}

std::size_t row_of(const FrameContext& context) {
    return static_cast<std::size_t>(context.like.width) * static_cast<std::size_t>(context.like.channels);
}

// Calls body(y0, rows) with the rows of a frame, which it may change, kRows at a time.
template <class Body>
void for_rows(Frame& frame, const FrameContext& context, const Body& body) {
    std::vector<float> rows;
    for (int y0 = 0; y0 < context.like.height; y0 += kRows) {
        const int y1 = std::min(y0 + kRows, context.like.height);
        rows.resize(row_of(context) * static_cast<std::size_t>(y1 - y0));
        frame.read(0, y0, rows);
        body(y0, rows);
        frame.write(0, y0, rows);
    }
}

void add(PhotoFile& file, const FrameContext& context, float weight, AveragedFrame& average) {
    const PhotoHeader& header = file.header();
    const bool is_light = header.is_raw || (header.is_float && !context.float_codes);
    const Transfer transfer = is_light ? Transfer{} : context.encoding;
    const float clipped = header.is_float && is_light ? std::numeric_limits<float>::infinity() : kClipped;
    std::vector<float> stored;
    double sum = 0;
    std::size_t bright = 0, missing = 0;
    for_rows(*average.frame, context, [&](int y0, std::vector<float>& rows) {
        stored.resize(rows.size());
        file.read_rows(y0, y0 + static_cast<int>(rows.size() / row_of(context)), stored);
        if (context.full_scale != 1 || context.float_codes)
            divide_by_full_scale(stored, context.full_scale, !is_light);
        for (std::size_t i = 0; i < rows.size(); ++i) {
            if (std::isnan(stored[i])) {  // no sample: the mean is not known there
                rows[i] = stored[i];
                ++missing;
                continue;
            }
            const float linear = transfer.decode(stored[i]);
            rows[i] += weight * linear;
            sum += static_cast<double>(linear);
            bright += stored[i] >= clipped;
        }
    });
    const double values = static_cast<double>(row_of(context)) * header.height - static_cast<double>(missing);
    if (!(values > 0)) fail("{}: no pixel holds a number; it cannot be used", file.path().string());
    average.summary.without_number += file.without_number();
    average.summary.mean += static_cast<double>(weight) * sum / values;
    average.summary.clipped += static_cast<double>(weight) * static_cast<double>(bright) / values;
}

}  // namespace

AveragedFrame average_frame(const fs::path& path, const std::string& role, const FrameContext& context) {
    AveragedFrame result;
    result.summary.files = files_of(path, role);
    for (const fs::path& file : result.summary.files)  // the first bad one is named before any work
        require_alike(PhotoFile(file, context.demosaic), role, context);
    // New room on disk reads as zeros.
    result.frame = std::make_shared<Frame>(1, context.like.height, row_of(context), "the " + role);
    const float weight = 1 / static_cast<float>(result.summary.files.size());
    for (const fs::path& name : result.summary.files) {
        PhotoFile file(name, context.demosaic);
        add(file, context, weight, result);
    }
    return result;
}

void subtract_dark(AveragedFrame& frame, const Frame* dark, double exposure, const FrameContext& context) {
    std::vector<float> offset(row_of(context) * kRows);
    double sum = 0;
    long values = 0;
    for_rows(*frame.frame, context, [&](int y0, std::vector<float>& rows) {
        if (dark) dark->read(0, y0, std::span(offset).first(rows.size()));
        for (std::size_t i = 0; i < rows.size(); ++i) {
            rows[i] = static_cast<float>((rows[i] - (dark ? offset[i] : 0)) / exposure);
            if (std::isnan(rows[i])) continue;
            sum += static_cast<double>(rows[i]);
            ++values;
        }
    });
    frame.summary.mean = sum / static_cast<double>(std::max(values, 1L));
}

std::shared_ptr<Frame> gain_of_flat(AveragedFrame& flat, const Frame* dark, const FrameContext& context) {
    FrameSummary& summary = flat.summary;
    const std::string name = summary.files.front().string();
    if (summary.clipped > kMostClipped)
        fail(
            "{}: {:.0f} % of the flat field's values are clipped, so it does not tell how bright the light "
            "is there; take it with a shorter exposure (about half of full scale)",
            name, 100 * summary.clipped);
    subtract_dark(flat, dark, 1, context);
    const auto channels = static_cast<std::size_t>(context.like.channels);
    std::vector<double> mean(channels, 0.0);
    std::size_t known = 0;  // values
    for_rows(*flat.frame, context, [&](int, std::vector<float>& rows) {
        for (std::size_t i = 0; i < rows.size(); ++i) {
            if (std::isnan(rows[i])) continue;
            mean[i % channels] += static_cast<double>(rows[i]);
            ++known;
        }
    });
    const double pixels = static_cast<double>(context.like.width) * context.like.height;
    const double darkest = context.like.is_float && !context.float_codes ? 0 : kDarkestMean;
    for (double& m : mean) {
        m /= static_cast<double>(std::max(known / channels, std::size_t{1}));
        if (!(m > darkest))
            fail("{}: the flat field is black{}; it must show an even white surface in the light", name,
                 dark ? " once the dark frame is taken off" : "");
    }
    double unusable = 0;
    for_rows(*flat.frame, context, [&](int, std::vector<float>& rows) {
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const double relative = static_cast<double>(rows[i]) / mean[i % channels];
            const bool usable = relative >= kDarkestFlat;
            unusable += !usable;
            if (usable) summary.darkest = std::min(summary.darkest, relative);
            rows[i] = usable ? static_cast<float>(1 / relative) : std::numeric_limits<float>::quiet_NaN();
        }
    });
    summary.unusable = unusable / (pixels * static_cast<double>(channels));
    if (summary.unusable > kMostUnusable)
        fail(
            "{}: {:.0f} % of the flat field are darker than a tenth of its mean; it must show an even white "
            "surface that fills the picture",
            name, 100 * summary.unusable);
    return flat.frame;
}

}  // namespace tangi
