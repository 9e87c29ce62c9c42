#include "capture/stack/photo_screening.h"

#include <algorithm>
#include <map>
#include <tuple>

#include "surface/image_file/image_alpha.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

// A picture is a mask where all but this part of it [1], which edges may have, is black or white.
constexpr double kMostGrey = 0.05;
constexpr float kBlackOrWhite = 0.1f;  // [1] from 0 or 1

std::string described(const PhotoHeader& header) {
    return fmt::format("{} x {}, {}", header.width, header.height, header.channels == 1 ? "grey" : "colour");
}

auto kind_of(const PhotoHeader& h) {
    return std::tuple(h.width, h.height, h.channels, h.bits, h.is_float, h.is_raw, h.orientation);
}

bool is_mask(const fs::path& path, const Region& photo) {
    try {
        const PhotoHeader header = PhotoFile(path).header();
        if (header.width != photo.width() || header.height != photo.height()) return false;
        const Image<float> mask = read_photo_mask(path);
        std::size_t black = 0, white = 0;
        for (const float value : mask.pixels()) {
            black += value <= kBlackOrWhite;
            white += value >= 1 - kBlackOrWhite;
        }
        const double all = static_cast<double>(mask.size());
        return white > 0 && static_cast<double>(black + white) >= (1 - kMostGrey) * all;
    } catch (const Error&) {
        return false;  // damaged: no mask
    }
}

}  // namespace

std::vector<fs::path> files_of(const StackPhoto& photo) {
    if (photo.exposures.empty()) return {photo.path};
    std::vector<fs::path> files;
    for (const Exposure& exposure : photo.exposures) files.push_back(exposure.path);
    return files;
}

std::string difference(const PhotoHeader& header, const PhotoHeader& other, const std::string& name) {
    if (header.width != other.width || header.height != other.height)
        return fmt::format("is {}, but {} is {}; all photographs of a stack must have the same size",
                           described(header), name, described(other));
    if (header.channels != other.channels)
        return fmt::format("is {}, but {} is {}; convert it, or remove it from the lights file",
                           described(header), name, described(other));
    if (header.bits != other.bits || header.is_float != other.is_float || header.is_raw != other.is_raw)
        return fmt::format(
            "has {} bits a sample{}, but {} has {}{}; all photographs of a stack must be stored alike",
            header.bits, header.is_raw ? " (raw)" : "", name, other.bits, other.is_raw ? " (raw)" : "");
    if (header.orientation != other.orientation)
        return fmt::format("its EXIF orientation is {}, that of {} is {}; turn the photographs alike first",
                           header.orientation, name, other.orientation);
    return {};
}

void tell(const std::vector<RejectedPhoto>& rejected, std::size_t first, std::vector<std::string>& warnings) {
    for (std::size_t i = first; i < rejected.size(); ++i)
        if (i == first ||
            rejected[i].reason != rejected[i - 1].reason)  // several that are missing are told once
            warnings.push_back(rejected[i].reason + "; rejected");
}

void leave_out_unusable(Stack& stack, std::vector<RejectedPhoto>& rejected) {
    const std::size_t before = rejected.size();
    std::map<fs::path, PhotoHeader> headers;
    std::erase_if(stack.photos, [&](const StackPhoto& photo) {
        for (const fs::path& path : files_of(photo)) try {
                headers[path] = PhotoFile(path).header();
            } catch (const PhotoError& error) {
                rejected.push_back({photo.light.name, error.what()});
                return true;
            }
        return false;
    });
    using Kind = decltype(kind_of(PhotoHeader{}));
    std::map<Kind, std::size_t> counts;
    const fs::path* most = nullptr;  // the first of the kind that is most frequent
    for (const StackPhoto& photo : stack.photos) ++counts[kind_of(headers[photo.path])];
    for (const StackPhoto& photo : stack.photos)
        if (!most || counts[kind_of(headers[photo.path])] > counts[kind_of(headers[*most])])
            most = &photo.path;
    const fs::path like = most ? *most : fs::path();
    std::erase_if(stack.photos, [&](const StackPhoto& photo) {
        for (const fs::path& path : files_of(photo)) {
            const std::string why = difference(headers[path], headers[like], like.filename().string());
            if (why.empty()) continue;
            rejected.push_back({photo.light.name, fmt::format("{}: {}", path.string(), why)});
            return true;
        }
        return false;
    });
    tell(rejected, before, stack.warnings);
}

Image<float> read_photo_mask(const fs::path& path) {
    const PictureWithAlpha picture = read_picture_with_alpha(path);
    Image<float> mask(picture.colour.width(), picture.colour.height());
    for (std::size_t i = 0; i < mask.size(); ++i) {
        const Rgb& value = picture.colour.pixels()[i];
        mask.pixels()[i] = std::max({value.r, value.g, value.b});
    }
    see_through(mask, picture.alpha);
    return mask;
}

std::optional<fs::path> mask_among(const std::vector<fs::path>& masks, const Region& photo,
                                   std::vector<std::string>& warnings) {
    std::vector<fs::path> fitting;
    for (const fs::path& path : masks)
        if (is_mask(path, photo)) fitting.push_back(path);
    for (const fs::path& path : masks)
        if (fitting.size() == 1 && path == fitting.front())
            warnings.push_back(fmt::format(
                "{}: taken for the mask, as its name says and it is black and white; --mask none fits the "
                "whole picture",
                path.string()));
        else
            warnings.push_back(fmt::format(
                "{}: rejected, since its name says that it is a mask; --mask FILE names one to use",
                path.string()));
    return fitting.size() == 1 ? std::optional(fitting.front()) : std::nullopt;
}

}  // namespace tangi
