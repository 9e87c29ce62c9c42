// jpeg_header.cpp: the segments of a JPEG file (ITU-T T.81, annex B).
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string_view>

#include "surface/image_file/exif_block.h"
#include "surface/image_file/icc_profile.h"
#include "surface/image_file/jpeg_segments.h"
#include "surface/image_file/picture_header.h"

namespace tangi {

namespace {

using std::string_view_literals::operator""sv;

constexpr int kExifMarker = 0xE1, kProfileMarker = 0xE2, kPhotoshopMarker = 0xED, kComment = 0xFE;
constexpr std::string_view kExifName = "Exif\0\0"sv, kXmpName = "http://ns.adobe.com/xap/1.0/\0"sv,
                           kProfileName = "ICC_PROFILE\0"sv, kPhotoshopName = "Photoshop 3.0\0"sv;

bool is_metadata(int marker) { return (marker >= 0xE0 && marker <= 0xEF) || marker == kComment; }
bool is_frame(int marker) {
    return marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
}

// A segment with what it holds, of those that a library looks into.
struct JpegPart : JpegSegment {
    std::string content{};
};

std::optional<JpegPart> part_at(const FileBytes& file, std::uint64_t begin) {
    const auto segment = jpeg_segment_at(file, begin);
    if (!segment) return {};
    JpegPart part{*segment};
    if (is_metadata(part.marker) || is_frame(part.marker) || part.marker == kJpegScan)
        part.content = file.bytes(part.content_at, part.end - part.content_at);
    return part;
}

std::string as_segment(int marker, const std::string& content) {
    const std::size_t length = content.size() + 2;
    return {'\xFF', static_cast<char>(marker), static_cast<char>(length >> 8),
            static_cast<char>(length & 255)};
}

// Photoshop's block: its first resource is IPTC's, of which OpenImageIO 2.4 believes the length.
bool is_plain_photoshop(std::string_view content) {
    constexpr std::size_t head = 26;
    if (content.size() < head) return false;
    return number_in(content.substr(18, 2), true) != 1028 ||
           head + number_in(content.substr(24, 2), true) <= content.size();
}

// What to show a library instead of a segment of metadata: nothing where that is the segment itself.
std::optional<std::string> instead_of_segment(const JpegPart& segment) {
    const std::string_view content = segment.content;
    // Names are compared as texts that end with a 0, which must be there.
    const bool named = content.substr(0, kXmpName.size()).find('\0') != std::string_view::npos;
    const bool looked_at = segment.marker == kExifMarker || segment.marker == kProfileMarker ||
                           segment.marker == kPhotoshopMarker;
    if (!looked_at) return {};
    if (segment.marker == kExifMarker && content.starts_with("Exif\0"sv)) {
        if (content.size() < kExifName.size()) return "";
        const std::string_view block = content.substr(kExifName.size());
        if (is_sound_exif(block)) return {};
        const std::string sound = sound_part_of_exif(block);
        const std::string whole = std::string(kExifName) + sound;
        return sound.empty() ? sound : as_segment(kExifMarker, whole) + whole;
    }
    const bool plain = segment.marker == kExifMarker && content.starts_with(kXmpName) ? is_plain_xmp(content)
                       : segment.marker == kProfileMarker && content.starts_with(kProfileName)
                           ? content.size() >= kProfileName.size() + 2
                       : segment.marker == kPhotoshopMarker && content.starts_with(kPhotoshopName)
                           ? is_plain_photoshop(content)
                           : named;
    return plain ? std::nullopt : std::optional<std::string>("");
}

// The profile, which lies in parts of 64 KiB, each with its number and their count (ICC.1:2010, B.4).
class ProfileParts {
public:
    // False where it is none.
    bool add(const std::string& content) {
        const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(content[i]); };
        if (!content.starts_with(kProfileName) || content.size() < kProfileName.size() + 2) return false;
        count_ = byte(kProfileName.size() + 1);
        parts_.emplace(byte(kProfileName.size()), content.substr(kProfileName.size() + 2));
        return true;
    }
    std::optional<std::string> damage() const {
        if (parts_.empty()) return {};
        std::string whole;
        for (int number = 1; number <= count_; ++number) {
            const auto part = parts_.find(number);
            if (part == parts_.end()) return fmt::format("its part {} of {} is missing", number, count_);
            whole += part->second;
        }
        return damage_of_icc(whole);
    }

private:
    int count_ = 0;
    std::map<int, std::string> parts_;
};

struct JpegScans {
    int channels = 0;
    bool progressive = false, arithmetic = false;
    bool in_several = false;  // of which libjpeg reads all before it gives the first row
};

void read_frame(const JpegPart& segment, PictureHeader& header, JpegScans& scans) {
    const std::string_view content = segment.content;
    if (content.size() < 6) return;
    header.height = static_cast<double>(number_in(content.substr(1, 2), true));
    header.width = static_cast<double>(number_in(content.substr(3, 2), true));
    scans.channels = static_cast<unsigned char>(content[5]);
    header.bytes = header.width * header.height * scans.channels;
    header.of_inks = scans.channels == 4;
    scans.progressive = (segment.marker & 3) == 2;
    scans.arithmetic = segment.marker >= 0xC9;
}

}  // namespace

void read_jpeg_header(const FileBytes& file, PictureHeader& header) {
    std::vector<FilePiece> pieces = {{0, 2}};
    ProfileParts profile;
    JpegScans scans;
    std::vector<std::size_t> of_profile;  // pieces
    bool changed = false, in_scan = false;
    std::uint64_t at = 2;
    while (const auto begin = next_jpeg_marker(file, at, in_scan)) {
        const auto segment = part_at(file, *begin);
        if (!segment || segment->marker == kJpegEnd) break;
        if (in_scan) pieces.push_back({at, *begin - at});
        const bool behind_pixels = in_scan;
        in_scan = segment->marker == kJpegScan;
        at = segment->end;
        std::optional<std::string> instead;
        if (is_frame(segment->marker)) read_frame(*segment, header, scans);
        if (is_metadata(segment->marker)) {
            if (segment->marker == kProfileMarker && profile.add(segment->content))
                of_profile.push_back(pieces.size());
            instead = behind_pixels ? std::optional<std::string>("") : instead_of_segment(*segment);
        }
        changed = changed || instead;
        pieces.push_back(instead ? FilePiece{*begin, 0, *instead} : FilePiece{*begin, segment->end - *begin});
        if (!in_scan) continue;
        const int here = segment->content.empty() ? 0 : static_cast<unsigned char>(segment->content[0]);
        scans.in_several = scans.in_several || scans.progressive || here < scans.channels;
        if (!scans.in_several) break;
    }
    pieces.push_back({at, file.size() - std::min(at, file.size())});
    header.profile_damage = profile.damage();
    if (header.profile_damage)
        for (const std::size_t piece : of_profile) pieces[piece].length = 0, changed = true;
    if (changed) header.without = std::move(pieces);
    // libjpeg keeps what it needs of all scans as 16 bits a sample.
    if (scans.in_several) header.held = 2 * header.bytes;
    // A code is a bit at least, and 8 x 8 pixels of the brightness begin with one (ITU-T T.81, F.1.2);
    // arithmetic coding can do with less.
    header.least_file = scans.arithmetic ? 0 : header.width * header.height / 512;
}

}  // namespace tangi
