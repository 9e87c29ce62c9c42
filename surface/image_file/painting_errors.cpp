#include "surface/image_file/painting_errors.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string_view>

#include "surface/base/json_text.h"
#include "surface/base/memory_error.h"
#include "surface/file/file_bytes.h"
#include "surface/image_file/exr_header_check.h"

namespace tangi {

namespace {

constexpr const char* kRemedy = "copy it again, or take a copy from before";

// What the operating system said, where a file cannot be opened: the last words of the library's.
std::string_view refusal_in(std::string_view words) {
    constexpr std::string_view cannot = "Cannot open image file ";
    if (!words.starts_with(cannot)) return {};
    const auto end = words.rfind("\". ");
    return end == std::string_view::npos ? std::string_view() : words.substr(end + 3);
}

// Throws Error where the file cannot be opened.
bool begins_as_exr(const std::filesystem::path& path) {
    std::array<char, 4> magic{};
    errno = 0;
    std::ifstream file(path, std::ios::binary);
    if (!file) fail("{}: cannot be read: {}", path.string(), std::strerror(errno));
    file.read(magic.data(), magic.size());
    return magic == std::array<char, 4>{'\x76', '\x2f', '\x31', '\x01'};
}

}  // namespace

void fail_reading(const std::filesystem::path& path, const std::exception& error) {
    if (says_no_memory(error)) fail("{}: {} to read it", path.string(), kNoMemory);
    const std::string_view words = error.what();
    const auto says = [&](std::string_view part) { return words.find(part) != std::string_view::npos; };
    if (const std::string_view refusal = refusal_in(words); !refusal.empty())
        fail("{}: cannot be read: {}", path.string(), first_line(refusal));
    require_readable(path);
    if (!begins_as_exr(path)) fail("{}: is not a painting file: it is no EXR file", path.string());
    if (says("Early end of file") || says("incomplete"))
        fail("{}: is damaged: it ends before all of the painting was read; {}", path.string(), kRemedy);
    if (words.starts_with("its rows"))  // exr_parallel_reader.h
        fail("{}: is damaged: {}; {}", path.string(), words, kRemedy);
    if (says("pixel data"))
        fail("{}: is damaged: a block of its pixels cannot be unpacked; {}", path.string(), kRemedy);
    fail("{}: is damaged, or no painting file: its header makes no sense; {}", path.string(), kRemedy);
}

void require_whole(const std::filesystem::path& path) {
    const auto claim = exr_claim(path);
    if (claim && (claim->malformed || claim->impossible || claim->cut_off)) require_readable(path);
    if (claim && claim->malformed)
        fail("{}: is damaged: its header makes no sense; {}", path.string(), kRemedy);
    if (claim && claim->impossible)
        fail("{}: is damaged: it is too short for the {} pixels that its header speaks of; {}", path.string(),
             *claim->impossible, kRemedy);
    if (claim && claim->cut_off)
        fail("{}: is damaged: it ends before the last of its pixels; {}", path.string(), kRemedy);
}

}  // namespace tangi
