#include "capture/radiometry/develop_stack.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "capture/photo/photo_metadata.h"
#include "capture/photo/raw_file.h"
#include "capture/radiometry/developed_samples.h"
#include "capture/radiometry/full_scale.h"
#include "capture/radiometry/transfer_decision.h"
#include "capture/stack/photo_screening.h"
#include "capture/stack/photo_source.h"
#include "capture/stack/survey.h"
#include "surface/base/error.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kRawBytesPerPixel = 30;      // of memory, while LibRaw decodes
constexpr std::size_t kMostRawBytesPerPixel = 60;  // ... by AAHD; DCB takes 45
constexpr std::size_t kRawMemory = std::size_t{6} << 30;

bool needs_development(const Stack& stack) {
    const DevelopOptions& o = stack.develop;
    return stack.is_raw || o.dark || o.flat || o.ambient || o.brackets;
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

// How the stack's values become linear light, but for frames and clipping.
Development development_of(const Stack& stack, const TransferEstimate& encoding) {
    Development d;
    d.encoding = encoding.transfer;
    d.encoding_source = encoding.source;
    d.bits = stack.bits;
    d.demosaic = stack.develop.demosaic;
    if (d.bits != 32)
        for (int code = 0, codes = 1 << d.bits; code < codes; ++code)
            d.table.push_back(d.encoding.decode(static_cast<float>(code) / static_cast<float>(codes - 1)));
    if (d.table.empty()) d.sensor_clipped = d.clipped = std::numeric_limits<float>::infinity();
    return d;
}

// The development of one stack: frames are averaged in the order in which they build on each other.
class StackDeveloper {
public:
    StackDeveloper(Stack& stack, DevelopReport& report)
        : stack_(stack),
          report_(report),
          first_(stack.photos.front().path),
          context_{PhotoFile(first_).header(), first_,           report.encoding.transfer,
                   stack.develop.demosaic,     stack.full_scale, stack.float_codes},
          development_(std::make_shared<Development>(development_of(stack, report.encoding))),
          d_(*development_) {
        stack.development = development_;
        stack.bits = 32;
        stack.transfer = Transfer{};
    }
    void decode_raws(bool keep, const Progress& progress);
    void take_dark();
    void take_ambient();
    void take_flat();
    void finish();

private:
    void warn(std::string warning) { stack_.warnings.push_back(std::move(warning)); }
    void count_frame() {
        report_.scratch_bytes += static_cast<std::uint64_t>(context_.like.width) *
                                 static_cast<std::uint64_t>(context_.like.height) *
                                 static_cast<std::uint64_t>(context_.like.channels) * sizeof(float);
    }

    Stack& stack_;
    DevelopReport& report_;
    const fs::path first_;
    const FrameContext context_;
    const std::shared_ptr<Development> development_;
    Development& d_;
    AveragedFrame ambient_;
};

void StackDeveloper::decode_raws(bool keep, const Progress& progress) {
    std::vector<fs::path> files;
    for (const StackPhoto* photo : all_photos(stack_))
        for (const fs::path& file : files_of(*photo)) files.push_back(file);
    const RawHeader raw = read_raw_header(first_);
    report_.camera = raw.camera;
    if (keep) tangi::decode_raws(files, context_.like, d_, progress);
}

void StackDeveloper::take_dark() {
    const auto& path = stack_.develop.dark;
    if (!path) return;
    AveragedFrame dark = average_frame(*path, "dark frame", context_);
    report_.dark = dark.summary;
    if (const auto relative = relative_exposure(stack_, dark.summary);
        is_another(relative) && !stack_.develop.brackets)
        warn(fmt::format(
            "{}: the dark frame was taken with {:.3g} times the exposure of the photographs, says EXIF; "
            "its offset may be another",
            dark.summary.files.front().string(), *relative));
    d_.dark = dark.frame;
    count_frame();
}

// Where there is one; and checks the frames.
void StackDeveloper::take_ambient() {
    if (const auto& path = stack_.develop.ambient) {
        ambient_ = average_frame(*path, "photograph of the ambient light", context_);
        const auto relative = relative_exposure(stack_, ambient_.summary);
        if (is_another(relative))
            warn(fmt::format(
                "{}: the ambient light was taken with {:.3g} times the exposure of the photographs, says "
                "EXIF, and is scaled accordingly",
                ambient_.summary.files.front().string(), *relative));
        subtract_dark(ambient_, d_.dark.get(), is_another(relative) ? *relative : 1, context_);
        report_.ambient = ambient_.summary;
        count_frame();
    }
    check_frames(stack_, report_);  // of photographs from which it is not taken off yet
    d_.ambient = ambient_.frame;
}

void StackDeveloper::take_flat() {
    const auto& path = stack_.develop.flat;
    if (!path) return;
    AveragedFrame flat = average_frame(*path, "flat field", context_);
    d_.gain = gain_of_flat(flat, d_.dark.get(), context_);
    report_.flat = flat.summary;
    count_frame();
    if (flat.summary.unusable > 0)
        warn(
            fmt::format("{}: {:.2g} % of the flat field are darker than a tenth of its mean; nothing is "
                        "measured there",
                        flat.summary.files.front().string(), 100 * flat.summary.unusable));
}

void StackDeveloper::finish() {
    if (d_.raws) report_.scratch_bytes += d_.raws->bytes();
    if (stack_.is_raw && stack_.develop.raw_colour == RawColour::rec709)
        d_.colour = colour_of(read_raw_header(first_));
    find_clipping(stack_, report_, d_);
    for (const auto* frame : {&report_.dark, &report_.flat, &report_.ambient})
        if (*frame && (*frame)->without_number > 0)
            warn(fmt::format(
                "{}: {} pixels hold no number that light can have (NaN, infinite); nothing is measured there",
                (*frame)->files.front().string(), (*frame)->without_number));
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

    StackDeveloper developer(stack, report_);
    if (stack.is_raw) developer.decode_raws(run.keep_raws, progress);
    developer.take_dark();
    if (stack.develop.brackets) relate_exposures(stack, report_);
    developer.take_ambient();
    developer.take_flat();
    developer.finish();
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
