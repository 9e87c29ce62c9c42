#include "surface/jpeg_markers.h"

#include <cstring>
#include <fstream>

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
        if (here < count) stream_.seekg(static_cast<std::streamoff>(count - here), std::ios::cur);
    }
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
        stream_.read(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
        at_ = 0;
        end_ = static_cast<std::size_t>(stream_.gcount());
        return end_ > 0;
    }

    std::ifstream stream_;
    std::vector<char> buffer_;
    std::size_t at_ = 0, end_ = 0;
};

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
        has_scan = has_scan || marker == kScan;
        const int high = bytes.next(), low = bytes.next();
        if (low == kEnd) return false;
        if (const int length = 256 * high + low; length > 2) bytes.skip(static_cast<std::size_t>(length) - 2);
    }
    return false;
}

}  // namespace tangi
