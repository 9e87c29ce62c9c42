#include <ImfChannelList.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <libdeflate.h>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include <bit>
#include <cstring>
#include <mutex>
#include <stdexcept>
#include <vector>

#include "surface/base/parallel.h"
#include "surface/painting_file/exr_parallel_reader.h"

namespace tangi {

namespace {

// Of a row: where the channels that are wanted begin.
struct Layout {
    std::vector<std::size_t> offsets;  // [bytes], of each plane
    std::size_t row_bytes = 0;
    int width = 0, height = 0, rows = 0;  // rows: of a block
};

// ZIP's bytes are differences of neighbours, plus 128: to sums.
void undo_differences(unsigned char* bytes, std::size_t size) {
    std::size_t i = 0;
    unsigned char last = 128;
#ifdef __SSE2__
    const __m128i flip = _mm_set1_epi8(static_cast<char>(0x80));
    __m128i carry = flip;
    for (; i + 16 <= size; i += 16) {
        auto* const at = reinterpret_cast<__m128i*>(bytes + i);
        __m128i sum = _mm_xor_si128(_mm_loadu_si128(at), flip);
        sum = _mm_add_epi8(sum, _mm_slli_si128(sum, 1));
        sum = _mm_add_epi8(sum, _mm_slli_si128(sum, 2));
        sum = _mm_add_epi8(sum, _mm_slli_si128(sum, 4));
        sum = _mm_add_epi8(sum, _mm_slli_si128(sum, 8));
        _mm_storeu_si128(at, _mm_add_epi8(sum, carry));
        carry = _mm_add_epi8(carry, _mm_set1_epi8(static_cast<char>(_mm_extract_epi16(sum, 7) >> 8)));
    }
    if (i > 0) last = bytes[i - 1];
#endif
    for (; i < size; ++i) last = bytes[i] = static_cast<unsigned char>(last + bytes[i] - 128);
}

// ZIP puts the bytes of even places before those of odd ones.
void interleave(const unsigned char* halves, std::size_t size, unsigned char* out) {
    const unsigned char *even = halves, *odd = halves + (size + 1) / 2;
    std::size_t i = 0;
#ifdef __SSE2__
    for (; 2 * i + 32 <= size; i += 16) {
        const __m128i a = _mm_loadu_si128(reinterpret_cast<const __m128i*>(even + i));
        const __m128i b = _mm_loadu_si128(reinterpret_cast<const __m128i*>(odd + i));
        auto* const to = reinterpret_cast<__m128i*>(out + 2 * i);
        _mm_storeu_si128(to, _mm_unpacklo_epi8(a, b));
        _mm_storeu_si128(to + 1, _mm_unpackhi_epi8(a, b));
    }
#endif
    for (; 2 * i < size; ++i) {
        out[2 * i] = even[i];
        if (2 * i + 1 < size) out[2 * i + 1] = odd[i];
    }
}

// Nothing where the part is not packed as ours are.
std::optional<Layout> layout_of(const Imf::Header& header, std::span<const FloatPlane> planes) {
    if (std::endian::native != std::endian::little) return {};
    if (header.hasType() && header.type() != Imf::SCANLINEIMAGE) return {};
    const bool zip = header.compression() == Imf::ZIP_COMPRESSION,
               zips = header.compression() == Imf::ZIPS_COMPRESSION;
    if (!zip && !zips) return {};
    const auto& window = header.dataWindow();
    Layout layout{.offsets = std::vector<std::size_t>(planes.size(), SIZE_MAX), .rows = zip ? 16 : 1};
    layout.width = window.max.x - window.min.x + 1;
    layout.height = window.max.y - window.min.y + 1;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
        const Imf::Channel& channel = c.channel();
        if (channel.xSampling != 1 || channel.ySampling != 1) return {};
        for (std::size_t i = 0; i < planes.size(); ++i)
            if (planes[i].channel == c.name()) {
                if (channel.type != Imf::FLOAT) return {};
                layout.offsets[i] = layout.row_bytes;
            }
        layout.row_bytes += (channel.type == Imf::HALF ? 2u : 4u) * static_cast<std::size_t>(layout.width);
    }
    for (const std::size_t offset : layout.offsets)
        if (offset == SIZE_MAX) return {};
    return layout;
}

class Unpacker {
public:
    explicit Unpacker(const Layout& layout)
        : layout_(layout),
          most_(layout.row_bytes * static_cast<std::size_t>(layout.rows)),
          // What does not become smaller is stored as it is.
          packed_(std::make_unique_for_overwrite<char[]>(most_ + most_ / 64 + 1024)),
          halves_(std::make_unique_for_overwrite<unsigned char[]>(most_)),
          bytes_(std::make_unique_for_overwrite<unsigned char[]>(most_)),
          inflate_(libdeflate_alloc_decompressor(), &libdeflate_free_decompressor) {
        if (!inflate_) throw std::bad_alloc();
    }

    void unpack(const Imf::InputPart& part, int y, std::span<const FloatPlane> planes) {
        const int rows = std::min(layout_.rows, layout_.height - y);
        const std::size_t size = layout_.row_bytes * static_cast<std::size_t>(rows);
        int packed = 0;
        part.rawPixelDataToBuffer(y, packed_.get(), packed);
        const unsigned char* from = reinterpret_cast<const unsigned char*>(packed_.get());
        if (static_cast<std::size_t>(packed) < size) {
            if (libdeflate_zlib_decompress(inflate_.get(), packed_.get(), static_cast<std::size_t>(packed),
                                           halves_.get(), size, nullptr) != LIBDEFLATE_SUCCESS)
                throw std::runtime_error(
                    fmt::format("its rows {} to {} cannot be unpacked", y, y + rows - 1));
            undo_differences(halves_.get(), size);
            interleave(halves_.get(), size, bytes_.get());
            from = bytes_.get();
        }
        const auto width = static_cast<std::size_t>(layout_.width);
        for (int row = 0; row < rows; ++row, from += layout_.row_bytes)
            for (std::size_t i = 0; i < planes.size(); ++i) {
                const unsigned char* values = from + layout_.offsets[i];
                float* to = planes[i].base + static_cast<std::size_t>(y + row) * width * planes[i].stride;
                if (planes[i].stride == 1) {
                    std::memcpy(to, values, width * sizeof(float));
                    continue;
                }
                for (std::size_t x = 0; x < width; ++x, values += sizeof(float), to += planes[i].stride)
                    std::memcpy(to, values, sizeof(float));
            }
    }

private:
    const Layout& layout_;
    std::size_t most_;  // [bytes] of a block
    std::unique_ptr<char[]> packed_;
    std::unique_ptr<unsigned char[]> halves_, bytes_;
    std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> inflate_;
};

// Of all threads, as many as there are: their memory is touched once.
struct Unpackers {
    std::mutex mutex;
    std::vector<std::unique_ptr<Unpacker>> idle;
};

class Lent {
public:
    Lent(Unpackers& from, const Layout& layout) : from_(from) {
        const std::lock_guard lock(from_.mutex);
        if (from_.idle.empty()) {
            unpacker_ = std::make_unique<Unpacker>(layout);
        } else {
            unpacker_ = std::move(from_.idle.back());
            from_.idle.pop_back();
        }
    }
    ~Lent() {
        const std::lock_guard lock(from_.mutex);
        from_.idle.push_back(std::move(unpacker_));
    }
    Unpacker* operator->() const { return unpacker_.get(); }
    Lent(const Lent&) = delete;
    Lent& operator=(const Lent&) = delete;

private:
    Unpackers& from_;
    std::unique_ptr<Unpacker> unpacker_;
};

}  // namespace

bool read_scan_blocks(const std::filesystem::path& path, const std::string& name,
                      std::span<const FloatPlane> planes, const std::function<void(int, int)>& rows_read,
                      const Progress& progress) {
    Imf::MultiPartInputFile file(path.c_str(), 0);
    int number = 0;
    while (number < file.parts() && !(file.header(number).hasName() && file.header(number).name() == name))
        ++number;
    if (number == file.parts()) return false;
    const std::optional<Layout> layout = layout_of(file.header(number), planes);
    if (!layout) return false;
    const Imf::InputPart part(file, number);
    const int blocks = (layout->height + layout->rows - 1) / layout->rows;
    Unpackers unpackers;
    const int at_once = std::max(1, 256 / layout->rows) * thread_count();
    for (int first = 0; first < blocks; first += at_once) {
        report(progress, "read painting", first / static_cast<double>(blocks));
        parallel_for(first, std::min(first + at_once, blocks), 2, [&](int begin, int end) {
            const Lent unpacker(unpackers, *layout);
            for (int block = begin; block < end; ++block) {
                const int y = block * layout->rows;
                unpacker->unpack(part, y, planes);
                rows_read(y, std::min(y + layout->rows, layout->height));
            }
        });
    }
    return true;
}

}  // namespace tangi
