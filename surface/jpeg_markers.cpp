#include "surface/jpeg_markers.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

namespace tangi {

namespace {

constexpr int kEnd = -1;  // of the file

// The bytes of a file, one after the other.
class ByteStream {
public:
    explicit ByteStream(const std::filesystem::path& path)
        : stream_(path, std::ios::binary), buffer_(std::size_t{1} << 18) {}

    int next() {
        if (at_ == end_ && !fill()) return kEnd;
        return static_cast<unsigned char>(buffer_[at_++]);
    }
    void skip(std::size_t count) {
        const std::size_t here = std::min(count, end_ - at_);
        at_ += here;
        if (here == count) return;
        stream_.seekg(static_cast<std::streamoff>(count - here), std::ios::cur);
        begin_ += count - here;
    }
    // [bytes] Of the next one from the file's beginning.
    std::uintmax_t position() const { return begin_ + at_; }
    // Goes behind the next byte of this value; false where there is none.
    bool find(int byte) {
        do {
            const void* found = end_ > at_ ? std::memchr(&buffer_[at_], byte, end_ - at_) : nullptr;
            if (found) {
                at_ = static_cast<std::size_t>(static_cast<const char*>(found) - buffer_.data()) + 1;
                return true;
            }
        } while (fill());
        return false;
    }

private:
    bool fill() {
        begin_ += end_;
        stream_.read(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
        at_ = 0;
        end_ = static_cast<std::size_t>(stream_.gcount());
        return end_ > 0;
    }

    std::ifstream stream_;
    std::vector<char> buffer_;
    std::size_t at_ = 0, end_ = 0;  // in the buffer
    std::uintmax_t begin_ = 0;      // of the buffer in the file
};

// Whether a file whose scans begin at `scans` ends with EOI, but for some zeros: then nothing is cut off.
bool ends_with_picture(const std::filesystem::path& path, std::uintmax_t scans) {
    constexpr std::uintmax_t tail = 4096;
    std::error_code unknown;
    const std::uintmax_t size = std::filesystem::file_size(path, unknown);
    if (unknown || size <= scans) return false;
    std::string bytes(std::min(size - scans, tail), '\0');
    std::ifstream stream(path, std::ios::binary);
    stream.seekg(static_cast<std::streamoff>(size - bytes.size()));
    stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    bytes.erase(bytes.find_last_not_of('\0') + 1);
    return stream && bytes.ends_with("\xFF\xD9");
}

// Those that stand alone (table B.1): stuffed zeros of a scan, TEM, restarts, the picture's start.
bool has_no_segment(int marker) {
    return marker == 0x00 || marker == 0x01 || (marker >= 0xD0 && marker <= 0xD8);
}

}  // namespace

bool is_whole_jpeg(const std::filesystem::path& path) {
    constexpr int kPrefix = 0xFF, kStart = 0xD8, kFinish = 0xD9, kScan = 0xDA;
    ByteStream bytes(path);
    if (bytes.next() != kPrefix || bytes.next() != kStart) return true;
    bool has_scan = false;
    while (bytes.find(kPrefix)) {
        int marker = kPrefix;
        while (marker == kPrefix) marker = bytes.next();  // any number of fill bytes
        if (marker == kEnd) return false;
        if (marker == kFinish) return has_scan;
        if (has_no_segment(marker)) continue;
        if (marker == kScan && !has_scan) {
            has_scan = true;
            if (ends_with_picture(path, bytes.position())) return true;  // most do, and need not be read
        }
        const int high = bytes.next(), low = bytes.next();
        if (low == kEnd) return false;
        if (const int length = 256 * high + low; length > 2) bytes.skip(static_cast<std::size_t>(length) - 2);
    }
    return false;
}

}  // namespace tangi
