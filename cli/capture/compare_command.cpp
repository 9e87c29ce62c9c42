// compare_command.cpp: tangipaint compare PAINTING.exr PHOTOS --out DIR
#include <algorithm>
#include <filesystem>

#include "cli/arguments.h"
#include "cli/capture/photo_source.h"
#include "cli/command_list.h"
#include "cli/result_summary.h"
#include "fit/evaluate/compare_page.h"
#include "fit/light_checks/list_order.h"
#include "fit/pipeline/preprocess.h"
#include "surface/base/error.h"
#include "surface/painting_file/painting_file.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

struct CompareArguments {
    std::string painting, out;
    PhotosArguments photos;
    CompareOptions options;
};

// Below this the relit picture is another picture: wrong lights, another painting, another crop.
constexpr double kPoorPsnr_db = 15;

// The report must not land on what it is made from.
void require_place_for_report(const CompareArguments& arguments, const Stack& photos) {
    const fs::path out = arguments.out, pictures = out / "pictures";
    std::vector<fs::path> inputs = arguments.photos.inputs(photos);
    for (const fs::path& input : inputs)
        if (fs::exists(pictures) && fs::equivalent(fs::absolute(input).parent_path(), pictures))
            fail(
                "--out {}: its pictures would be written among the photographs, as {} is one; choose another "
                "folder",
                arguments.out, input.string());
    inputs.emplace_back(arguments.painting);
    for (const char* file : {"compare.html", "compare.json"}) refuse_to_overwrite(out / file, inputs);
    require_writable_folder(out);
}

// The part that the painting was fitted from, where the user names none and the whole is larger.
UsableStack open_photographs(PhotosArguments& arguments, const Surface& surface) {
    UsableStack opened = arguments.open();
    const std::string fitted = crop_fitted(surface);
    const bool same_size =
        opened.stack.width() == surface.width() && opened.stack.height() == surface.height();
    if (!arguments.crop.empty() || fitted.empty() || same_size) return opened;
    arguments.crop = fitted;
    return arguments.open();
}

// What is wrong with a part of the photographs that is not the one that the painting was fitted from; empty
// where it is that one, or these are other photographs.
std::string doubt_of_crop(const PhotosArguments& arguments, const Stack& stack, const Surface& surface) {
    PhotosArguments as_fitted = arguments;
    as_fitted.crop = crop_fitted(surface);
    const bool known = std::any_of(stack.photos.begin(), stack.photos.end(), [&](const StackPhoto& photo) {
        return find_photo(surface.photography, photo.light) != nullptr;
    });
    if (!known || arguments.crop.empty() || as_fitted.crop.empty()) return {};
    try {
        if (as_fitted.open().stack.crop == stack.crop) return {};
    } catch (const Error&) {
        return {};  // that part is not in these photographs: they are others
    }
    return fmt::format(
        "--crop {} is another part of the photographs than the painting was fitted from, which is --crop {}: "
        "leave --crop out, and that part is compared",
        arguments.crop, as_fitted.crop);
}

// As the fit looks for it, by what the photographs show without the painting.
std::string doubt_of_order(const Stack& stack, const Survey& surveyed, const Transfer& transfer,
                           const LightAxes& axes) {
    std::vector<int> lines;
    std::vector<std::string> names;
    for (const StackPhoto& photo : stack.photos) {
        lines.push_back(photo.number);
        names.push_back(photo.light.name);
    }
    const ListOrder order =
        check_list_order(surveyed, transfer, stack.lights(), lines, stack.width(), stack.height());
    return doubt_of(order, SignCheck{}, axes, names);
}

nlohmann::json run_compare(CompareArguments arguments) {
    const Progress progress = console_progress();
    const Surface surface = read_painting(arguments.painting, progress);
    UsableStack opened = open_photographs(arguments.photos, surface);
    Stack& photos = opened.stack;
    require_place_for_report(arguments, photos);
    auto [stack, development] = photos_to_compare(std::move(photos), arguments.photos, surface, progress);
    // Neighbours in a list are neighbours by name.
    std::ranges::sort(stack.photos, {}, &StackPhoto::path);
    Survey surveyed;
    const std::vector<RejectedPhoto> rejected = leave_out_damaged_and_copies(stack, progress, &surveyed);
    const RelightingResidual residual = read_residual(arguments.painting, surface, progress);
    CompareReport report =
        write_comparison(arguments.out, surface, stack, arguments.options, progress, residual);
    nlohmann::json result = to_json(report);
    result["development"] = to_json(development);
    result["page"] = (fs::path(arguments.out) / "compare.html").string();
    result["warnings"] = told(report.warnings);
    result["rejected"] = to_json(rejected);
    result["poor"] = opened.poor;
    if (const std::string doubt = doubt_of_crop(arguments.photos, stack, surface); !doubt.empty())
        result["poor"].push_back(doubt);
    if (!report.foreign.empty()) result["poor"].push_back(report.foreign);
    if (!report.exchanged.empty())
        result["poor"].push_back(report.exchanged);
    else if (const std::string doubt =
                 doubt_of_order(stack, surveyed, report.transfer, arguments.photos.axes());
             !doubt.empty())
        result["poor"].push_back(doubt);
    if (report.all.psnr_db < kPoorPsnr_db)
        result["poor"].push_back(
            fmt::format("the relit pictures differ from the photographs by {:.1f} dB on average; are these "
                        "the photographs, and "
                        "the lights, of this painting?",
                        report.all.psnr_db));
    return result;
}

}  // namespace

Command compare_command() {
    return {"compare", "compare a painting, relit, with photographs, in numbers and pictures",
            [](Flags& flags) {
                auto a = std::make_shared<CompareArguments>();
                flags.option("PAINTING", a->painting, "painting (.exr, or .tangi, a folder)").required();
                a->photos.add_to(flags, false);
                flags.option("--out", a->out, "folder for compare.html, compare.json and the pictures")
                    .required();
                flags.fields(a->options);
                return [a] { return run_compare(*a); };
            },
            compare_in_words};
}

}  // namespace tangi
