#include "cli/capture/photo_source.h"

#include "fit/evaluate/compare_page.h"
#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/report/false_colour.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr int kScaleColours = 33;
constexpr double kShownPixels = 16e6;  // of a picture in the window; larger ones are shown reduced

nlohmann::json member(const nlohmann::json& object, const char* name) {
    return object.is_object() && object.contains(name) ? object[name] : nlohmann::json();
}

nlohmann::json provenance_of(const Surface& surface) { return json_or_discarded(surface.provenance); }

// How the files were encoded that the painting was fitted from, where they were developed first: their light
// must be found in the same way again.
std::optional<Transfer> encoding_fitted(const Surface& surface) {
    const nlohmann::json encoding = member(member(provenance_of(surface), "development"), "encoding");
    if (!encoding.is_string()) return std::nullopt;
    return transfer_named(encoding.get<std::string>());
}

// What the fit was told about its photographs.
PhotosArguments remembered(const fs::path& folder, const Surface& surface) {
    const nlohmann::json photos = member(member(provenance_of(surface), "options"), "photos");
    PhotosArguments arguments;
    const auto take = [&](const char* name, std::string& value, bool is_file) {
        const nlohmann::json found = member(photos, name);
        if (!found.is_string()) return;
        const fs::path given = found.get<std::string>();
        if (given.empty()) return;  // as options say that were not given
        for (const fs::path& path : {is_file ? folder / given : given, given})
            if (!is_file || fs::exists(path)) return void(value = path.string());
    };
    take("crop", arguments.crop, false);
    take("mask", arguments.mask, true);
    take("lights", arguments.lights, true);
    take("capture", arguments.capture, true);
    take("light_axes", arguments.light_axes, false);
    if (const nlohmann::json deg = member(photos, "light_rotation_deg"); deg.is_number())
        arguments.light_rotation_deg = deg;
    // Of version 0.1.
    const auto is_set = [&](const char* name) { return member(photos, name) == nlohmann::json(true); };
    if (is_set("lights_flip_x") || is_set("lights_flip_y"))
        arguments.light_axes =
            in_words({.flip_x = is_set("lights_flip_x"), .flip_y = is_set("lights_flip_y")});
    if (const nlohmann::json deg = member(photos, "lights_turn_deg"); deg.is_number())
        arguments.light_rotation_deg = deg;
    return arguments;
}

Stack open_as_fitted(PhotosArguments arguments, const Surface& surface) {
    const PhotosArguments fitted = remembered(arguments.folder, surface);
    if (arguments.crop.empty()) arguments.crop = fitted.crop;
    if (arguments.mask.empty()) arguments.mask = fitted.mask;
    arguments.light_axes = fitted.light_axes;
    arguments.light_rotation_deg = fitted.light_rotation_deg;
    if (!arguments.lights.empty() || !arguments.capture.empty() ||
        (fitted.lights.empty() && fitted.capture.empty()))
        return arguments.open_any();
    try {
        return arguments.open_any();  // of lights, what lies in the folder comes first
    } catch (const Error& error) {
        arguments.lights = fitted.lights;
        arguments.capture = fitted.capture;
        try {
            return arguments.open_any();
        } catch (const Error&) {
            throw error;
        }
    }
}

ColourScale scale_of(ColourMap map, double lowest, double highest) {
    ColourScale scale{{}, lowest, highest};
    for (int i = 0; i < kScaleColours; ++i)
        scale.colours_srgb.push_back(colour_at(map, i / double(kScaleColours - 1)));
    return scale;
}

HeldPhoto::Picture in_8_bits(const Image<Rgb>& picture, int reduced) {
    const Image<Rgb> shown = reduced == 1 ? picture
                                          : resized(picture, (picture.width() + reduced - 1) / reduced,
                                                    (picture.height() + reduced - 1) / reduced);
    HeldPhoto::Picture bytes(shown.width(), shown.height());
    for (std::size_t i = 0; i < shown.size(); ++i)
        bytes.pixels()[i] = glm::u8vec3(glm::round(glm::clamp(shown.pixels()[i], 0.0f, 1.0f) * 255.0f));
    return bytes;
}

template <class T>
Image<T> part_of(const Image<T>& image, const Region& region) {
    Image<T> part(region.width(), region.height());
    for (int y = 0; y < part.height(); ++y)
        std::copy_n(image.row(region.y0 + y).begin() + region.x0, part.width(), part.row(y).begin());
    return part;
}

// The pictures as they were compared, for statistics of a part.
struct Measured {
    Image<Rgb> photo, relit;
    Image<float> delta_e;
    PixelMask mask;

    Likeness in(Region region) const {
        region = {std::max(region.x0, 0), std::max(region.y0, 0), std::min(region.x1, photo.width()),
                  std::min(region.y1, photo.height())};
        if (region.empty()) return {};
        const PixelMask counts = part_of(mask, region);
        Likeness likeness;
        for (const unsigned char pixel : counts.pixels()) likeness.pixels += pixel != 0;
        if (likeness.pixels == 0) return likeness;
        const Image<Rgb> a = part_of(photo, region), b = part_of(relit, region);
        const Image<float> difference = part_of(delta_e, region);
        likeness.psnr_db = std::min(psnr_db(a, b, counts), kPsnrCap_db);
        likeness.ssim = ssim(a, b, counts);
        likeness.delta_e_2000 = mean(difference, counts);
        likeness.delta_e_2000_p95 = percentile(difference, 0.95, counts);
        return likeness;
    }
};

class StackBook : public PhotoBook {
public:
    StackBook(PhotosToCompare photos, std::shared_ptr<const Surface> surface, RelightingResidual residual)
        : photos_(std::move(photos)),
          surface_(std::move(surface)),
          residual_(std::move(residual)),
          difference_(scale_of(ColourMap::diverging, -options_.error_range, options_.error_range)),
          delta_e_(scale_of(ColourMap::sequential, 0, options_.delta_e_range)) {
        all_ = photos_.stack.photos;
        all_.insert(all_.end(), photos_.stack.held_out.begin(), photos_.stack.held_out.end());
        for (const StackPhoto& photo : all_) {
            const Photography::Photo* known = find_photo(surface_->photography, photo.light);
            entries_.push_back({photo.light.name, as_photographed(photo.light, surface_->photography),
                                known && known->fitted});
        }
    }

    const std::vector<Entry>& entries() const override { return entries_; }
    const std::vector<std::string>& warnings() const override { return photos_.stack.warnings; }
    const ColourScale& difference_scale() const override { return difference_; }
    const ColourScale& delta_e_scale() const override { return delta_e_; }

    HeldPhoto hold(int index, const Progress& progress) const override {
        Stack one = photos_.stack;
        one.photos = {all_.at(static_cast<std::size_t>(index))};
        one.held_out.clear();
        HeldPhoto held;
        held.index = index;
        auto measured = std::make_shared<Measured>();
        const auto sink = [&](const ComparedPictures& pictures) {
            *measured = {pictures.photo, pictures.relit, pictures.delta_e, pictures.mask};
            const PhotoComparison& r = pictures.result;
            for (const unsigned char pixel : pictures.mask.pixels()) held.whole.pixels += pixel != 0;
            held.whole = {held.whole.pixels, r.psnr_db, r.ssim, r.delta_e_2000, r.delta_e_2000_p95};
            while (static_cast<double>(measured->photo.size()) > kShownPixels * held.reduced * held.reduced)
                ++held.reduced;
            held.photo = in_8_bits(for_display(pictures.photo, pictures), held.reduced);
            held.relit = in_8_bits(for_display(pictures.relit, pictures), held.reduced);
            held.difference =
                in_8_bits(map_picture(luma_difference(pictures.photo, pictures.relit), difference_.lowest,
                                      difference_.highest, ColourMap::diverging, pictures.mask),
                          held.reduced);
            held.delta_e = in_8_bits(map_picture(pictures.delta_e, delta_e_.lowest, delta_e_.highest,
                                                 ColourMap::sequential, pictures.mask),
                                     held.reduced);
        };
        compare(*surface_, one, options_, progress, sink);
        held.bytes = measured->photo.size() * (2 * sizeof(Rgb) + sizeof(float) + 1) +
                     held.photo.size() * 4 * sizeof(glm::u8vec3);
        held.measure = [measured](const Region& region) { return measured->in(region); };
        return held;
    }

    void write_report(const fs::path& folder, const std::vector<int>& rejected,
                      const Progress& progress) const override {
        Stack stack = photos_.stack;
        stack.photos.clear();
        stack.held_out.clear();
        for (std::size_t i = 0; i < all_.size(); ++i) {
            const bool out =
                std::find(rejected.begin(), rejected.end(), static_cast<int>(i)) != rejected.end();
            if (out)
                stack.warnings.push_back(
                    fmt::format("{}: rejected: it cannot be read", all_[i].path.string()));
            else
                stack.photos.push_back(all_[i]);
        }
        require_writable_folder(folder);
        write_comparison(folder, *surface_, stack, options_, progress, residual_);
    }

private:
    PhotosToCompare photos_;
    std::shared_ptr<const Surface> surface_;
    RelightingResidual residual_;
    CompareOptions options_;
    ColourScale difference_, delta_e_;
    std::vector<StackPhoto> all_;
    std::vector<Entry> entries_;
};

}  // namespace

std::string crop_fitted(const Surface& surface) { return remembered({}, surface).crop; }

PhotosToCompare photos_to_compare(Stack stack, const PhotosArguments& arguments, const Surface& surface,
                                  const Progress& progress) {
    if (!stack.transfer) stack.transfer = encoding_fitted(surface);
    // Each photograph is read once, from top to bottom: raws need no copy on disk.
    DevelopReport development = develop_stack(stack, {.keep_raws = false}, progress);
    if (!development.developed && arguments.transfer == "auto") stack.transfer.reset();
    return {std::move(stack), std::move(development)};
}

std::unique_ptr<PhotoBook> open_photo_book(const PhotosArguments& arguments,
                                           std::shared_ptr<const Surface> surface, const fs::path& painting,
                                           const Progress& progress) {
    Stack stack = open_as_fitted(arguments, *surface);
    if (surface->photography.photos.empty())
        fail(
            "{}: this painting does not come from photographs: it holds no transfer curve and no lights, so "
            "it cannot be compared with {}",
            painting.filename().string(), arguments.folder);
    if (stack.width() != surface->width() || stack.height() != surface->height())
        fail("{}: the photographs are {} x {}, the painting is {} x {}: they are of another painting or crop",
             arguments.folder, stack.width(), stack.height(), surface->width(), surface->height());
    RelightingResidual residual = read_residual(painting, *surface, progress);
    PhotosToCompare photos = photos_to_compare(std::move(stack), arguments, *surface, progress);
    return std::make_unique<StackBook>(std::move(photos), std::move(surface), std::move(residual));
}

}  // namespace tangi
