#include "surface/image_file/safe_picture.h"

#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "surface/base/error.h"
#include "surface/base/json_text.h"
#include "surface/base/words.h"
#include "surface/file/anonymous_temp_file.h"
#include "surface/file/file_bytes.h"
#include "surface/image_file/exr_header_check.h"
#include "surface/image_file/file_kind.h"
#include "surface/image_file/painting_errors.h"
#include "surface/image_file/picture_header.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr const char* kUnpacked = "what must be unpacked of it at once";
constexpr const char* kCopyAgain = "copy it again, or take a copy from before";

const char* reader_named(PictureFormat format) {
    switch (format) {
        case PictureFormat::png:
            return "png";
        case PictureFormat::jpeg:
            return "jpeg";
        case PictureFormat::tiff:
            return "tiff";
        case PictureFormat::exr:
            return "openexr";
        case PictureFormat::bmp:
            return "bmp";
        case PictureFormat::tga:
            break;
    }
    return "targa";
}

[[noreturn]] void fail_as_too_large(const fs::path& path, double pixels) {
    fail(
        "{}: has {:.0f} million pixels, and pictures of up to {:.0f} million are read; reduce it, or cut it "
        "in parts",
        path.string(), pixels / 1e6, kMostPixels / 1e6);
}

void require_possible(const fs::path& path, const FileBytes& file, const PictureHeader& header) {
    if (header.least_file > static_cast<double>(file.size()))
        fail("{}: is damaged: it says that it has {} x {} pixels, which its {} bytes cannot hold; {}",
             path.string(), header.width, header.height, file.size(), kCopyAgain);
    if (header.width * header.height > kMostPixels) fail_as_too_large(path, header.width * header.height);
    if (header.damage) fail("{}: is damaged: {}; {}", path.string(), *header.damage, kCopyAgain);
}

// Throws Error where there is no room for it.
int sound_copy_of(const fs::path& path, const FileBytes& file, const std::vector<FilePiece>& pieces) {
    constexpr std::uint64_t at_once = 1u << 20;
    const std::string folder = folder_for_scratch();
    const int copy = open_nameless_file(folder);
    int error = copy < 0 ? errno : 0;
    std::uint64_t to = 0;
    const auto append = [&](const std::string& bytes) {
        if (error == 0) error = write_at(copy, to, std::as_bytes(std::span(bytes)));
        to += bytes.size();
    };
    for (const FilePiece& piece : pieces) {
        append(piece.instead);
        for (std::uint64_t done = 0; done < piece.length && error == 0; done += at_once)
            append(file.bytes(piece.begin + done, std::min(at_once, piece.length - done)));
    }
    if (error == 0) return copy;
    if (copy >= 0) ::close(copy);
    fail("{}: its metadata are damaged, and a copy without them cannot be made in {}: {}", path.string(),
         folder, std::strerror(error));
}

}  // namespace

SafePicture::SafePicture(const fs::path& path) : path_(path.string()) {
    const FileBytes file(path);
    const auto format = picture_format(file, lower_case(path.extension().string()));
    if (!format) fail("{}: {}", path.string(), what_it_is_instead(file));
    reader_ = reader_named(*format);
    if (*format == PictureFormat::exr) {
        require_whole(path);
        const auto claim = exr_claim(path);
        if (claim && claim->pixels > kMostPixels) fail_as_too_large(path, claim->pixels);
        if (claim) claim_ = MemoryClaim(path, claim->held, kUnpacked);
        return;
    }
    const PictureHeader header = picture_header(file, *format);
    require_possible(path, file, header);
    claim_ = MemoryClaim(path, header.held, kUnpacked);
    profile_damage_ = header.profile_damage;
    of_inks_ = header.of_inks;
    if (header.without.empty()) return;
    copy_ = sound_copy_of(path, file, header.without);
    path_ = fmt::format("/proc/self/fd/{}", copy_);
}

SafePicture::~SafePicture() {
    if (copy_ >= 0) ::close(copy_);
}

SafePicture::SafePicture(SafePicture&& other) noexcept
    : path_(std::move(other.path_)),
      claim_(std::move(other.claim_)),
      of_inks_(other.of_inks_),
      reader_(other.reader_),
      profile_damage_(std::move(other.profile_damage_)),
      copy_(std::exchange(other.copy_, -1)) {}

SafePicture& SafePicture::operator=(SafePicture&& other) noexcept {
    std::swap(path_, other.path_);
    std::swap(claim_, other.claim_);
    std::swap(of_inks_, other.of_inks_);
    std::swap(reader_, other.reader_);
    std::swap(profile_damage_, other.profile_damage_);
    std::swap(copy_, other.copy_);
    return *this;
}

namespace {

// In words of ours, where the library's tell of one of these; else `otherwise`.
std::string in_our_words(const fs::path& path, std::string_view library_words, const char* otherwise) {
    const std::string words = lower_case(library_words);
    const auto says = [&](std::initializer_list<std::string_view> parts) {
        return std::ranges::any_of(
            parts, [&](std::string_view part) { return words.find(part) != std::string::npos; });
    };
    if (says({"memory", "bad_alloc", "limits:"})) return "there is not enough memory for it";
    for (const int error : {EACCES, EMFILE, ENFILE, EIO, ENOENT})
        if (says({lower_case(std::strerror(error))})) return std::strerror(error);
    // Libraries take what the disk does not give for the file's end.
    if (const auto trouble = trouble_reading(path)) return *trouble;
    if (says({"end of file", "premature", "truncat", "not enough", "no data", "missing",
              "read error on strip"}))
        return fmt::format("it ends before all of its pixels, as if cut off; {}", kCopyAgain);
    return fmt::format("{}; {}", otherwise, kCopyAgain);
}

}  // namespace

std::string trouble_with_picture(const fs::path& path, std::string_view library_words) {
    return in_our_words(path, library_words, "its header is damaged, or of a kind that is not known");
}

std::string trouble_with_pixels(const fs::path& path, std::string_view library_words) {
    return in_our_words(path, library_words, "its pixels are damaged");
}

}  // namespace tangi
