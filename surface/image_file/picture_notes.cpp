#include "surface/image_file/picture_notes.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>

#include "surface/base/error.h"
#include "surface/base/html_escape.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"
#include "surface/file/file_bytes.h"
#include "surface/file/version.h"

namespace tangi {

namespace {

std::string element(std::string_view name, const std::string& text, std::string_view container = {}) {
    if (text.empty()) return {};
    const std::string value = escaped(valid_utf8(text));
    if (container.empty()) return fmt::format("<{0}>{1}</{0}>", name, value);
    const char* language = container == "Alt" ? " xml:lang=\"x-default\"" : "";
    return fmt::format("<{0}><rdf:{1}><rdf:li{2}>{3}</rdf:li></rdf:{1}></{0}>", name, container, language,
                       value);
}

// Whole numbers of 2 or 4 bytes, the lowest first.
std::uint32_t number_at(std::string_view bytes, std::size_t at, int length) {
    return static_cast<std::uint32_t>(number_in(bytes.substr(at, static_cast<std::size_t>(length)), false));
}

std::string bytes_of(std::uint32_t value, int bytes) {
    std::string text;
    for (int i = 0; i < bytes; ++i) text.push_back(static_cast<char>(value >> 8 * i & 0xff));
    return text;
}

std::string jpeg_with(std::string file, std::string_view packet) {
    constexpr std::string_view id("http://ns.adobe.com/xap/1.0/\0", 29);
    const std::size_t length = 2 + id.size() + packet.size();
    if (length > 0xffff) return file;
    std::string segment = "\xff\xe1";
    segment.push_back(static_cast<char>(length >> 8));
    segment.push_back(static_cast<char>(length & 0xff));
    segment.append(id).append(packet);
    return file.insert(2, segment);
}

// What comes behind a TIFF file that has so many bytes: the packet, and the directory anew, with one entry
// more at its place in the order of tags. `directory` gets the place of that.
std::string behind_tiff(std::string_view old, std::uint64_t size, std::string_view packet,
                        std::uint32_t& directory) {
    constexpr std::uint32_t tag = 700, type_byte = 1;
    constexpr std::size_t entry_bytes = 12;
    std::string behind(size % 2, '\0');
    const std::string entry = bytes_of(tag, 2) + bytes_of(type_byte, 2) +
                              bytes_of(static_cast<std::uint32_t>(packet.size()), 4) +
                              bytes_of(static_cast<std::uint32_t>(size + behind.size()), 4);
    behind.append(packet);
    if (behind.size() % 2 != size % 2) behind.push_back('\0');
    directory = static_cast<std::uint32_t>(size + behind.size());
    std::size_t before = 2;
    while (before + 4 < old.size() && number_at(old, before, 2) < tag) before += entry_bytes;
    behind += bytes_of(number_at(old, 0, 2) + 1, 2);
    return behind.append(old.substr(2, before - 2)).append(entry).append(old.substr(before));
}

void overwrite(const std::filesystem::path& path, const std::string& bytes) {
    errno = 0;
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file << bytes << std::flush;
    if (!file) fail("{}: cannot be written: {}", path.string(), std::strerror(errno));
}

void add_to_tiff(const std::filesystem::path& path, std::string_view packet) {
    std::string old, behind;
    std::uint32_t directory = 0;
    {
        const FileBytes file(path);
        const auto at = file.number(4, 4, false);
        const auto count = at ? file.number(*at, 2, false) : std::nullopt;
        if (!count || file.size() + packet.size() > 0xf0000000) return;
        old = file.bytes(*at, 2 + *count * 12 + 4);
        if (old.size() != 2 + *count * 12 + 4) return;
        behind = behind_tiff(old, file.size(), packet, directory);
    }
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(0, std::ios::end);
    errno = 0;
    file << behind << std::flush;
    if (file) file.seekp(4) << bytes_of(directory, 4) << std::flush;
    if (!file) fail("{}: cannot be written: {}", path.string(), std::strerror(errno));
}

}  // namespace

std::string xmp_packet(const PictureNotes& notes) {
    return fmt::format(
        "<?xpacket begin=\"\xef\xbb\xbf\" id=\"W5M0MpCehiHzreSzNTczkc9d\"?><x:xmpmeta "
        "xmlns:x=\"adobe:ns:meta/\">"
        "<rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\"><rdf:Description rdf:about=\"\" "
        "xmlns:dc=\"http://purl.org/dc/elements/1.1/\" xmlns:xmp=\"http://ns.adobe.com/xap/1.0/\" "
        "xmlns:photoshop=\"http://ns.adobe.com/photoshop/1.0/\" xmlns:tangipaint=\"urn:tangipaint:\">"
        "{}{}{}{}{}{}{}</rdf:Description></rdf:RDF></x:xmpmeta><?xpacket end=\"w\"?>",
        element("dc:title", notes.title, "Alt"), element("dc:creator", notes.creator, "Seq"),
        element("dc:description", notes.description, "Alt"), element("dc:source", notes.source),
        element("photoshop:Credit", notes.credit), element("xmp:CreatorTool", program_name()),
        notes.mm_per_pixel > 0
            ? element("tangipaint:MillimetresPerPixel", fmt::format("{:.6g}", notes.mm_per_pixel))
            : std::string());
}

void add_xmp(const std::filesystem::path& path, std::string_view packet) {
    const std::string begin = FileBytes(path).bytes(0, 4);
    if (begin.starts_with("\xff\xd8"))
        overwrite(path, jpeg_with(read_text_file(path), packet));
    else if (begin == std::string_view("II*\0", 4))
        add_to_tiff(path, packet);
}

}  // namespace tangi
