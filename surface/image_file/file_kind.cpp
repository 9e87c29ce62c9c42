#include "surface/image_file/file_kind.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "surface/base/words.h"

namespace tangi {

namespace {

using std::string_view_literals::operator""sv;

constexpr const char* kConvert = "whatever it is called: convert it to TIFF, PNG or JPEG";
constexpr const char* kFetchAgain =
    "not a picture: a download or copy that failed leaves that; fetch it again";
constexpr const char* kNameRaw =
    "whatever it is called: give it its own extension, or convert it to DNG or TIFF";

struct Beginning {
    std::size_t at;
    std::string_view bytes;
    const char* kind;
    const char* remedy;
};

// Of ISO media files (ISO/IEC 14496-12) the brand tells, at 8 behind "ftyp".
constexpr std::array<Beginning, 12> kBrands = {{{8, "heic"sv, "a HEIC photograph", kConvert},
                                                {8, "heix"sv, "a HEIC photograph", kConvert},
                                                {8, "hevc"sv, "a HEIC photograph", kConvert},
                                                {8, "heim"sv, "a HEIC photograph", kConvert},
                                                {8, "heis"sv, "a HEIC photograph", kConvert},
                                                {8, "mif1"sv, "a HEIF photograph", kConvert},
                                                {8, "msf1"sv, "a HEIF photograph", kConvert},
                                                {8, "avif"sv, "an AVIF picture", kConvert},
                                                {8, "avis"sv, "an AVIF picture", kConvert},
                                                {8, "crx "sv, "a camera raw (CR3)", kNameRaw},
                                                {8, "qt  "sv, "a film (QuickTime)", "not a photograph"},
                                                {8, ""sv, "a film (MP4)", "not a photograph"}}};

constexpr std::array<Beginning, 27> kBeginnings = {
    {{8, "WEBP"sv, "a WebP picture", kConvert},
     {0, "GIF8"sv, "a GIF picture", kConvert},
     {0, "\xFF\x0A"sv, "a JPEG XL picture", kConvert},
     {0, "\0\0\0\x0CJXL "sv, "a JPEG XL picture", kConvert},
     {0, "\0\0\0\x0CjP  "sv, "a JPEG 2000 picture", kConvert},
     {0, "\xFF\x4F\xFF\x51"sv, "a JPEG 2000 picture", kConvert},
     {0, "II\xBC"sv, "a JPEG XR picture", kConvert},
     {0, "8BPS"sv, "a Photoshop file (PSD)", kConvert},
     {0, "gimp xcf"sv, "a GIMP file (XCF)", kConvert},
     {0, "#?RADIANCE"sv, "a Radiance picture (HDR)", "whatever it is called: convert it to EXR"},
     {0, "#?RGBE"sv, "a Radiance picture (HDR)", "whatever it is called: convert it to EXR"},
     {0, "P6"sv, "a PPM picture", kConvert},
     {0, "P5"sv, "a PGM picture", kConvert},
     {0, "PF"sv, "a PFM picture", "whatever it is called: convert it to EXR"},
     {0, "SIMPLE  ="sv, "a FITS picture", "whatever it is called: convert it to a TIFF of floats, or EXR"},
     {0, "FUJIFILMCCD-RAW"sv, "a camera raw (RAF)", kNameRaw},
     {0, "IIU\0"sv, "a camera raw (RW2)", kNameRaw},
     {0, "IIRO"sv, "a camera raw (ORF)", kNameRaw},
     {0, "IIRS"sv, "a camera raw (ORF)", kNameRaw},
     {0, "MMOR"sv, "a camera raw (ORF)", kNameRaw},
     {0, "FOVb"sv, "a camera raw (X3F)", kNameRaw},
     {0, "%PDF"sv, "a PDF document", "not a picture: export its pictures from it"},
     {0, "PK\3\4"sv, "a ZIP archive", "not a picture: unpack it"},
     {0, "\x1F\x8B"sv, "a compressed file (gzip)", "not a picture: unpack it"},
     {0, "\0\5\x16\7"sv, "what macOS keeps beside a file (AppleDouble)",
      "not the picture, which has the same name without \"._\" before it"},
     {0, "\0\5\x16\0"sv, "what macOS keeps of a file (AppleSingle)",
      "not the picture: copy that again, by another way"},
     {0, "version https://git-lfs"sv, "a pointer of Git LFS",
      "not the picture, which git lfs pull fetches"}}};

std::string in_words(const Beginning& found) { return fmt::format("{}, {}", found.kind, found.remedy); }

// A page that a server sent in place of the picture, or other text.
std::string of_text(std::string_view head) {
    const std::size_t first = head.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
    if (first == std::string_view::npos) return {};
    const std::string begin = lower_case(head.substr(first, 512));
    if (begin.starts_with("<!doctype html") || begin.starts_with("<html"))
        return fmt::format("a web page (HTML), {}", kFetchAgain);
    if (begin.starts_with("<svg") || (begin.starts_with("<?xml") && begin.find("<svg") != std::string::npos))
        return fmt::format("an SVG drawing, {}", kConvert);
    if (begin.starts_with("<?xml") || begin.starts_with("<x:xmpmeta")) return "an XML file, not a picture";
    const bool printable = std::all_of(head.begin(), head.end(), [](char c) {
        return static_cast<unsigned char>(c) >= 0x20 || c == '\n' || c == '\r' || c == '\t';
    });
    return printable ? fmt::format("a text, {}", kFetchAgain) : std::string();
}

}  // namespace

namespace {

// Empty where it is none of these.
std::string kind_of_file(const FileBytes& file) {
    if (file.size() == 0)
        return "empty (0 bytes), as a copy or download leaves it that failed; copy it again";
    const std::string head = file.bytes(0, std::min<std::uint64_t>(file.size(), 1024));
    const auto has = [&](const Beginning& b) {
        return head.size() >= b.at + b.bytes.size() && head.compare(b.at, b.bytes.size(), b.bytes) == 0;
    };
    if (head.compare(0, 4, "RIFF") == 0 && !has(kBeginnings[0]))
        return "a sound or a film (RIFF), not a photograph";
    if (head.size() >= 12 && head.compare(4, 4, "ftyp") == 0)
        return in_words(*std::find_if(kBrands.begin(), kBrands.end() - 1, has));
    if (const auto found = std::find_if(kBeginnings.begin(), kBeginnings.end(), has);
        found != kBeginnings.end())
        return in_words(*found);
    if (head.find_first_not_of('\0') == std::string::npos)
        return "nothing but zeros at its beginning, as a disk or a copy leaves it that failed; copy it again";
    return of_text(head);
}

}  // namespace

std::string what_it_is_instead(const FileBytes& file) {
    const std::string kind = kind_of_file(file);
    return "is not a picture that can be read: it is " +
           (kind.empty() ? "no PNG, JPEG, TIFF, EXR, TGA or BMP file" : kind);
}

}  // namespace tangi
