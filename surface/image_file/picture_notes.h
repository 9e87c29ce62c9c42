// picture_notes.h: what a picture says of itself to other programs: EXIF, IPTC, XMP, PNG text, EXR
// attributes.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace tangi {

// Empty fields are left out. The program is named in every picture.
struct PictureNotes {
    std::string title, creator, credit;
    std::string description;  // how it was made: light, model, encoding, in words
    std::string source;       // "sha256:" and 64 hex digits of the painting's file
    double mm_per_pixel = 0;  // [mm] 0 where unknown; also as pixels per inch, 25.4 over it

    bool empty() const {
        return title.empty() && creator.empty() && credit.empty() && description.empty() && source.empty() &&
               !(mm_per_pixel > 0);
    }
};

// An XMP packet (ISO 16684-1): dc:title, dc:creator, dc:description, dc:source, photoshop:Credit,
// xmp:CreatorTool, and tangipaint:MillimetresPerPixel.
std::string xmp_packet(const PictureNotes& notes);

// Puts the packet into a JPEG or TIFF file (classic, little-endian: as OpenImageIO 2.4 writes them, without a
// packet): a segment APP1, or tag 700. Others stay as they are. Throws Error, as on a full disk.
void add_xmp(const std::filesystem::path& path, std::string_view packet);

}  // namespace tangi
