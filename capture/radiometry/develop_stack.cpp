#include "capture/radiometry/develop_stack.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "capture/photo/exposure_merge.h"
#include "capture/photo/photo_metadata.h"
#include "capture/photo/raw_file.h"
#include "capture/radiometry/full_scale.h"
#include "capture/radiometry/transfer_decision.h"
#include "capture/stack/photo_screening.h"
#include "capture/stack/photo_source.h"
#include "capture/stack/survey.h"
#include "surface/base/error.h"
#include "surface/base/median.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr int kDevelopedRows = 64;                 // at a time
constexpr int kPhotosLookedAt = 5;                 // photographs that checks and brackets read
constexpr std::size_t kRawBytesPerPixel = 30;      // of memory, while LibRaw decodes
constexpr std::size_t kMostRawBytesPerPixel = 60;  // ... by AAHD; DCB takes 45
constexpr std::size_t kRawMemory = std::size_t{6} << 30;

bool needs_development(const Stack& stack) {
    const DevelopOptions& o = stack.develop;
    return stack.is_raw || o.dark || o.flat || o.ambient || o.brackets;
}

std::vector<StackPhoto*> all_photos(Stack& stack) {
    std::vector<StackPhoto*> all;
    for (StackPhoto& photo : stack.photos) all.push_back(&photo);
    for (StackPhoto& photo : stack.held_out) all.push_back(&photo);
    return all;
}

TransferEstimate encoding_of(Stack& stack, const Progress& progress) {
    if (stack.is_raw) return {Transfer{}, "camera raw", {}, {}};
    const bool may_be_scaled = stack.bits == 16 || (stack.bits == 32 && !stack.says_linear);
    if (!may_be_scaled && (stack.transfer || stack.bits == 32)) return estimate_transfer(stack, Survey{});
    Survey surveyed = survey(stack, {}, progress);
    if (take_full_scale(stack, surveyed)) surveyed = survey(stack, {}, progress);
    return decide_transfer(stack, surveyed);
}

// Decodes all raws of the stack once. LibRaw holds several copies of a picture, so few are decoded side by
// side.
void decode_raws(const std::vector<fs::path>& files, const PhotoHeader& header, Development& development,
                 const Progress& progress) {
    const auto row = static_cast<std::size_t>(header.width) * 3;
    const std::string what =
        fmt::format("{} developed camera raw{}", files.size(), files.size() == 1 ? "" : "s");
    const auto raws =
        std::make_shared<DevelopedRaws>(static_cast<int>(files.size()), header.height, row, what);
    const bool thrifty = development.demosaic != "AAHD" && development.demosaic != "DCB";
    const std::size_t bytes = (thrifty ? kRawBytesPerPixel : kMostRawBytesPerPixel) * row / 3 *
                              static_cast<std::size_t>(header.height);
    const int count = static_cast<int>(files.size());
    const int batch =
        std::clamp(static_cast<int>(kRawMemory / std::max<std::size_t>(bytes, 1)), 1, thread_count());
    for (int first = 0; first < count; first += batch) {
        report(progress, "develop", first / static_cast<double>(count));
        parallel_for(first, std::min(first + batch, count), 1, [&](int begin, int end) {
            for (int i = begin; i < end; ++i)
                raws->write(i, 0, develop_raw(files[static_cast<std::size_t>(i)], development.demosaic));
        });
    }
    report(progress, "develop", 1);
    for (int i = 0; i < count; ++i) development.raw_index[files[static_cast<std::size_t>(i)]] = i;
    development.raws = raws;
}

// A grid of pixels of one file as the development makes them so far, mean of the channels; NaN where clipped.
std::vector<float> sample_of(const Stack& stack, const fs::path& file, const Light& light) {
    PhotoSource source(stack, {file, light, 0, {}, {{file, 1.0}}});
    const PhotoHeader& header = source.header();
    const auto channels = static_cast<std::size_t>(header.channels);
    // The frames and exposures are those of the photographs, whatever picture is made of them.
    const Region part = stack.geometry ? Region{0, 0, header.width, header.height} : stack.crop;
    const std::size_t row = static_cast<std::size_t>(header.width) * channels;
    const int step =
        std::max(1, static_cast<int>(std::sqrt(static_cast<double>(part.width()) * part.height() / 20000)));
    std::vector<float> rows, sample;
    for (int y0 = 0; y0 < part.y1; y0 += kDevelopedRows) {
        const int y1 = std::min(y0 + kDevelopedRows, header.height);
        rows.resize(row * static_cast<std::size_t>(y1 - y0));
        source.read_rows(y0, y1, rows);
        for (int y = std::max(y0, part.y0); y < std::min(y1, part.y1); ++y)
            for (int x = part.x0; x < part.x1; x += step) {
                if ((y - part.y0) % step != 0) break;
                const float* value =
                    &rows[row * static_cast<std::size_t>(y - y0) + static_cast<std::size_t>(x) * channels];
                float sum = 0;
                for (std::size_t c = 0; c < channels; ++c)
                    sum += value[c] < stack.development->sensor_clipped
                               ? value[c]
                               : std::numeric_limits<float>::quiet_NaN();
                sample.push_back(sum / static_cast<float>(channels));
            }
    }
    return sample;
}

// Mean over what is not clipped; clipped pixels count as full scale.
double mean_of(const std::vector<float>& sample) {
    double sum = 0;
    for (const float value : sample) sum += std::isnan(value) ? 1.0 : static_cast<double>(value);
    return sample.empty() ? 0 : sum / static_cast<double>(sample.size());
}

// Photographs to look at, spread over the stack.
std::vector<const StackPhoto*> some_photos(const Stack& stack) {
    std::vector<const StackPhoto*> some;
    const std::size_t count = stack.photos.size(), wanted = std::min<std::size_t>(count, kPhotosLookedAt);
    for (std::size_t i = 0; i < wanted; ++i) some.push_back(&stack.photos[i * count / wanted]);
    return some;
}

// The settings of all brackets from the pixels of a few, put into the photographs.
void relate_exposures(Stack& stack, DevelopReport& report_) {
    std::set<double> distinct;
    for (StackPhoto* photo : all_photos(stack))
        for (const Exposure& exposure : photo->exposures) distinct.insert(exposure.relative);
    const std::vector<double> settings(distinct.begin(), distinct.end());
    const auto index = [&](double relative) {
        return static_cast<std::size_t>(std::lower_bound(settings.begin(), settings.end(), relative) -
                                        settings.begin());
    };
    std::vector<ExposurePair> pairs;
    for (const StackPhoto* photo : some_photos(stack)) {
        std::vector<Exposure> exposures = photo->exposures;
        std::sort(exposures.begin(), exposures.end(),
                  [](const Exposure& a, const Exposure& b) { return a.relative < b.relative; });
        std::vector<float> below;
        for (std::size_t k = 0; k < exposures.size(); ++k) {
            std::vector<float> sample = sample_of(stack, exposures[k].path, photo->light);
            if (k > 0)
                pairs.push_back(
                    {index(exposures[k].relative), index(exposures[k - 1].relative), sample, below});
            below = std::move(sample);
        }
    }
    const RefinedExposures refined = refine_exposures(settings, pairs);
    for (std::size_t k = 0; k < settings.size(); ++k) {
        report_.settings.push_back(
            {settings[k], refined.relative[k], refined.scatter[k], refined.refined[k]});
        if (k == 0) continue;
        const double given = settings[k] / settings[k - 1],
                     found = refined.relative[k] / refined.relative[k - 1];
        if (!refined.refined[k])
            stack.warnings.push_back(
                fmt::format("{}: no pixels are well exposed both at {:.4g} and at {:.4g} of the reference "
                            "exposure; their ratio is "
                            "taken as given",
                            stack.folder.string(), settings[k - 1], settings[k]));
        else if (std::abs(std::log(found / given)) > std::log(1.26))
            stack.warnings.push_back(
                fmt::format("{}: exposures said to differ by a factor of {:.3g} differ by {:.3g} in the "
                            "photographs, which is what is "
                            "used; check the brackets, and that all are stored alike",
                            stack.folder.string(), given, found));
        if (refined.scatter[k] > 0.02)
            stack.warnings.push_back(
                fmt::format("{}: the ratio of neighbouring exposures changes by {:.1f} % from light to "
                            "light: the lights or the "
                            "shutter are not steady",
                            stack.folder.string(), 100 * refined.scatter[k]));
    }
    for (StackPhoto* photo : all_photos(stack))
        for (Exposure& exposure : photo->exposures)
            exposure.relative = refined.relative[index(exposure.relative)];
}

// Frames that do not belong to these photographs show in their brightness.
void check_frames(Stack& stack, const DevelopReport& report_) {
    if (!report_.dark && !report_.ambient) return;
    double brightest = 0,
           below = 0;  // mean of the brightest photograph, dark frame taken off; part that is 0
    for (const StackPhoto* photo : some_photos(stack)) {
        const std::vector<float> sample = sample_of(stack, photo->path, photo->light);
        const double mean = mean_of(sample);
        if (mean < brightest) continue;
        brightest = mean;
        below = static_cast<double>(std::count(sample.begin(), sample.end(), 0.0f)) /
                static_cast<double>(std::max<std::size_t>(sample.size(), 1));
    }
    if (const auto& dark = report_.dark) {
        const std::string name = dark->files.front().string();
        if (below > 0.5)
            fail(
                "{}: the dark frame ({:.4f} of full scale on average) is brighter than {:.0f} % of the "
                "brightest photograph; it must be taken with the lens covered",
                name, dark->mean, 100 * below);
        if (dark->mean > brightest)
            stack.warnings.push_back(fmt::format(
                "{}: the dark frame ({:.4f} of full scale on average) is brighter than what it leaves of the "
                "photographs ({:.4f}); was the lens covered?",
                name, dark->mean, brightest));
    }
    if (const auto& ambient = report_.ambient) {
        const std::string name = ambient->files.front().string();
        const double part = ambient->mean / std::max(brightest, 1e-9);
        if (part >= 0.8)
            fail(
                "{}: the photograph of the ambient light has {:.0f} % of the brightness of the brightest "
                "photographs; the "
                "light must be off in it, and the room darker",
                name, 100 * part);
        if (part > 0.25)
            stack.warnings.push_back(
                fmt::format("{}: {:.0f} % of the light in the photographs is ambient; what is left when it "
                            "is taken off is noisy",
                            name, 100 * part));
    }
}

// Exposure of a frame in units of the reference exposure, by EXIF; empty where a file does not tell.
std::optional<double> relative_exposure(const Stack& stack, const FrameSummary& frame) {
    const StackPhoto& photo = stack.photos.front();
    const auto of_frame = exposure_of(read_photo_metadata(frame.files.front()));
    const auto of_photo = exposure_of(read_photo_metadata(photo.path));
    if (!of_frame || !of_photo) return std::nullopt;
    double relative = 1;
    for (const Exposure& exposure : photo.exposures)
        if (exposure.path == photo.path) relative = exposure.relative;
    return *of_frame / *of_photo * relative;
}

bool is_another(const std::optional<double>& relative) {
    return relative && std::abs(std::log(*relative)) > std::log(1.1);
}

// Camera colour -> linear Rec. 709 by what the first photograph says, the same for all.
glm::mat3 colour_of(const RawHeader& raw) {
    glm::mat3 colour(1);
    for (int row = 0; row < 3; ++row)
        for (int c = 0; c < 3; ++c)
            colour[c][row] = raw.to_rec709[static_cast<std::size_t>(3 * row + c)] *
                             raw.white_balance[static_cast<std::size_t>(c)];
    return colour;
}

// From which value on results are clipped: nothing else may come out as bright.
void find_clipping(const Stack& stack, const DevelopReport& report_, Development& d) {
    if (d.table.empty()) {
        d.clipped = d.sensor_clipped = std::numeric_limits<float>::infinity();
        return;
    }
    double shortest = 1;
    for (const Stack* s = &stack; const auto* list : {&s->photos, &s->held_out})
        for (const StackPhoto& photo : *list)
            for (const Exposure& exposure : photo.exposures) shortest = std::min(shortest, exposure.relative);
    const double gain = report_.flat ? 1 / report_.flat->darkest : 1;
    d.sensor_clipped = static_cast<float>(static_cast<double>(d.decode(kClipped)) / shortest * gain);
    d.clipped = d.sensor_clipped;
    if (!d.colour) return;
    float most = 0;
    for (int row = 0; row < 3; ++row) {
        float sum = 0;
        for (int c = 0; c < 3; ++c) sum += std::max((*d.colour)[c][row], 0.0f);
        most = std::max(most, sum);
    }
    d.clipped *= most;
}

}  // namespace

DevelopReport develop_stack(Stack& stack, const DevelopRun& run, const Progress& progress) {
    DevelopReport report_;
    if (stack.development || !needs_development(stack) || stack.photos.empty()) return report_;
    report_.developed = true;
    report_.options = stack.develop;
    report_.encoding = encoding_of(stack, progress);
    if (stack.is_raw && stack.transfer && *stack.transfer != Transfer{})
        stack.warnings.push_back(fmt::format("{}: camera raw is linear light; --transfer {} is not used",
                                             stack.folder.string(), stack.transfer->name()));
    if (!report_.encoding.warning.empty()) stack.warnings.push_back(report_.encoding.warning);

    const fs::path first = stack.photos.front().path;
    const FrameContext context{PhotoFile(first).header(), first,
                               report_.encoding.transfer, stack.develop.demosaic,
                               stack.full_scale,          stack.float_codes};
    const auto development = std::make_shared<Development>();
    Development& d = *development;
    d.encoding = report_.encoding.transfer;
    d.encoding_source = report_.encoding.source;
    d.bits = stack.bits;
    d.demosaic = stack.develop.demosaic;
    if (d.bits != 32)
        for (int code = 0, codes = 1 << d.bits; code < codes; ++code)
            d.table.push_back(d.encoding.decode(static_cast<float>(code) / static_cast<float>(codes - 1)));
    if (d.table.empty()) d.sensor_clipped = d.clipped = std::numeric_limits<float>::infinity();
    stack.development = development;
    stack.bits = 32;
    stack.transfer = Transfer{};

    std::vector<fs::path> files;
    for (const StackPhoto* photo : all_photos(stack))
        for (const fs::path& file : files_of(*photo)) files.push_back(file);
    if (stack.is_raw) {
        const RawHeader raw = read_raw_header(first);
        report_.camera = raw.camera;
        if (run.keep_raws) decode_raws(files, context.like, d, progress);
    }
    const auto frame_bytes = [&] {
        return static_cast<std::uint64_t>(context.like.width) *
               static_cast<std::uint64_t>(context.like.height) *
               static_cast<std::uint64_t>(context.like.channels) * sizeof(float);
    };
    if (const auto& path = stack.develop.dark) {
        AveragedFrame dark = average_frame(*path, "dark frame", context);
        report_.dark = dark.summary;
        if (const auto relative = relative_exposure(stack, dark.summary);
            is_another(relative) && !stack.develop.brackets)
            stack.warnings.push_back(fmt::format(
                "{}: the dark frame was taken with {:.3g} times the exposure of the photographs, says EXIF; "
                "its offset may be another",
                dark.summary.files.front().string(), *relative));
        d.dark = dark.frame;
        report_.scratch_bytes += frame_bytes();
    }
    if (stack.develop.brackets) relate_exposures(stack, report_);
    AveragedFrame ambient;
    if (const auto& path = stack.develop.ambient) {
        ambient = average_frame(*path, "photograph of the ambient light", context);
        const auto relative = relative_exposure(stack, ambient.summary);
        if (is_another(relative))
            stack.warnings.push_back(fmt::format(
                "{}: the ambient light was taken with {:.3g} times the exposure of the photographs, says "
                "EXIF, and is scaled accordingly",
                ambient.summary.files.front().string(), *relative));
        subtract_dark(ambient, d.dark.get(), is_another(relative) ? *relative : 1, context);
        report_.ambient = ambient.summary;
        report_.scratch_bytes += frame_bytes();
    }
    check_frames(stack, report_);
    d.ambient = ambient.frame;
    if (const auto& path = stack.develop.flat) {
        AveragedFrame flat = average_frame(*path, "flat field", context);
        d.gain = gain_of_flat(flat, d.dark.get(), context);
        report_.flat = flat.summary;
        report_.scratch_bytes += frame_bytes();
        if (flat.summary.unusable > 0)
            stack.warnings.push_back(
                fmt::format("{}: {:.2g} % of the flat field are darker than a tenth of its mean; nothing is "
                            "measured there",
                            flat.summary.files.front().string(), 100 * flat.summary.unusable));
    }
    if (d.raws) report_.scratch_bytes += d.raws->bytes();
    if (stack.is_raw && stack.develop.raw_colour == RawColour::rec709)
        d.colour = colour_of(read_raw_header(first));
    find_clipping(stack, report_, d);
    for (const auto* frame : {&report_.dark, &report_.flat, &report_.ambient})
        if (*frame && (*frame)->without_number > 0)
            stack.warnings.push_back(fmt::format(
                "{}: {} pixels hold no number that light can have (NaN, infinite); nothing is measured there",
                (*frame)->files.front().string(), (*frame)->without_number));
    return report_;
}

nlohmann::json to_json(const DevelopReport& r) {
    if (!r.developed) return nullptr;
    const auto frame = [](const std::optional<FrameSummary>& summary) -> nlohmann::json {
        if (!summary) return nullptr;
        nlohmann::json files = nlohmann::json::array();
        for (const fs::path& file : summary->files) files.push_back(file.filename().string());
        return {{"files", files}, {"mean", summary->mean}, {"clipped", summary->clipped}};
    };
    nlohmann::json result = {{"encoding", r.encoding.transfer.name()},
                             {"encoding_source", r.encoding.source},
                             {"dark", frame(r.dark)},
                             {"flat", frame(r.flat)},
                             {"ambient", frame(r.ambient)},
                             {"scratch_bytes", r.scratch_bytes}};
    if (r.flat) {
        result["flat"]["darkest"] = r.flat->darkest;
        result["flat"]["unusable"] = r.flat->unusable;
    }
    result["raw"] = nullptr;
    if (!r.camera.empty())
        result["raw"] = {{"camera", r.camera},
                         {"demosaic", r.options.demosaic},
                         {"colour", r.options.raw_colour == RawColour::rec709 ? "rec709" : "camera"}};
    result["brackets"] = nlohmann::json::array();
    for (const DevelopReport::Setting& s : r.settings)
        result["brackets"].push_back(
            {{"given", s.given}, {"relative", s.relative}, {"scatter", s.scatter}, {"refined", s.refined}});
    return result;
}

}  // namespace tangi
