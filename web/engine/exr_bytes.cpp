#include "web/engine/exr_bytes.h"

#include <algorithm>
#include <array>

#include "surface/base/error.h"
#include "surface/file/deflated.h"

namespace tangi {

namespace {

constexpr std::uint32_t kMagic = 20000630, kVersion = 2, kSeveralParts = 0x1000;
constexpr std::uint8_t kNotPacked = 0, kZip = 3;
constexpr std::uint32_t kHalf = 1, kFloat = 2;  // types of channels
constexpr int kMostSide = 65536;

struct Window {  // of pixels, its last ones included
    std::int32_t x0 = 0, y0 = 0, x1 = -1, y1 = -1;
};

constexpr std::uint64_t kReadAhead = 1 << 16;  // [bytes] More than the headers of most files
constexpr std::uint64_t kBlockHead = 12;       // [bytes] A block's part, first line and length
constexpr std::size_t kLongestName = 255;      // [bytes] OpenEXR's limit

// What stands in a file from a place on, a number or a text after the other.
class Reader {
public:
    // `ahead` [bytes]: so many are read at once where fewer are wanted.
    explicit Reader(const ByteSource& bytes, std::uint64_t at = 0, std::uint64_t ahead = kReadAhead)
        : bytes_(bytes), ahead_(ahead), next_(at) {
        if (at > bytes.size) fail("the painting file is cut short");
    }
    template <class T>
    T number() {
        T value;
        std::memcpy(&value, take(sizeof value).data(), sizeof value);
        return value;
    }
    std::string text() {  // up to a zero
        for (std::size_t length = 0;; ++length) {
            if (length > kLongestName) fail("the painting file is damaged");
            hold(length + 1);
            if (held_[at_ + length] != '\0') continue;
            std::string found = held_.substr(at_, length);
            at_ += length + 1;
            return found;
        }
    }
    std::string take(std::uint64_t count) {
        hold(count);
        at_ += static_cast<std::size_t>(count);
        return held_.substr(at_ - static_cast<std::size_t>(count), static_cast<std::size_t>(count));
    }

private:
    void hold(std::uint64_t count) {
        const std::uint64_t has = held_.size() - at_, left = bytes_.size - next_;
        if (count <= has) return;
        if (count - has > left) fail("the painting file is cut short");
        held_.erase(0, at_);
        at_ = 0;
        const auto more = static_cast<std::size_t>(std::min(std::max(count - has, ahead_), left));
        held_.resize(held_.size() + more);
        bytes_.read(next_, {held_.data() + has, more});
        next_ += more;
    }

    const ByteSource& bytes_;
    const std::uint64_t ahead_;
    std::uint64_t next_;  // what follows on held_
    std::string held_;
    std::size_t at_ = 0;  // in it
};

std::uint8_t packing_of(const ExrPart& part) { return part.get<std::uint8_t>("compression", 255); }
int rows_of_block(const ExrPart& part) { return packing_of(part) == kZip ? kExrRowsOfBlock : 1; }

// Files of one part do not say how many blocks of lines it has.
std::size_t blocks_of(const ExrPart& part) {
    const auto window = part.get<Window>("dataWindow", {});
    const int lines = std::clamp(window.y1, -1, kMostSide) + 1, each = rows_of_block(part);
    return static_cast<std::size_t>(
        std::clamp(part.get<std::int32_t>("chunkCount", (lines + each - 1) / each), 0, 1 << 20));
}

// Without attributes where no further part follows.
ExrPart next_part(Reader& bytes) {
    ExrPart part;
    for (std::string name; !(name = bytes.text()).empty();) {
        const std::string type = bytes.text();
        const auto size = bytes.number<std::uint32_t>();
        part.attributes[name] = {type, bytes.take(size)};
    }
    return part;
}

template <class T>
std::string bytes_of(const T& value) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    return bytes;
}

// ZIP packs the first bytes of all pairs before the second ones, and of each its difference from the one
// before.
std::string sorted_bytes(const std::string& values) {
    const std::size_t half = (values.size() + 1) / 2;
    std::string halves(values.size(), '\0');
    for (std::size_t i = 0; i < values.size(); ++i) halves[i % 2 == 0 ? i / 2 : half + i / 2] = values[i];
    std::string differences = halves;
    for (std::size_t i = 1; i < halves.size(); ++i)
        differences[i] = static_cast<char>(static_cast<unsigned char>(halves[i]) -
                                           static_cast<unsigned char>(halves[i - 1]) + 128);
    return differences;
}
// The first half and the second side by side: each byte waits for the one before it.
std::string unsorted_bytes(const std::string& differences) {
    const std::size_t size = differences.size(), half = (size + 1) / 2, pairs = size / 2;
    std::string values(size, '\0');
    const auto* from = reinterpret_cast<const unsigned char*>(differences.data());
    auto* to = reinterpret_cast<unsigned char*>(values.data());
    unsigned first = 128, second = 0;  // the first byte is no difference
    for (std::size_t i = 0; i < half; ++i) second += from[i] - 128u;
    second += 128;
    for (std::size_t i = 0; i < pairs; ++i) {
        first += from[i] - 128u;
        second += from[half + i] - 128u;
        to[2 * i] = static_cast<unsigned char>(first);
        to[2 * i + 1] = static_cast<unsigned char>(second);
    }
    if (half > pairs) to[size - 1] = static_cast<unsigned char>(first + from[half - 1] - 128u);
    return values;
}

std::string unpacked(std::string packed, std::size_t size) {
    if (packed.size() == size) return packed;  // where packing saved nothing
    const auto found = inflated(packed, size);
    if (!found || found->size() != size) fail("the painting file is damaged");
    return unsorted_bytes(*found);
}

std::string channel_list(const PartInfo& info) {
    std::string list;
    for (const std::string& name : info.channels) {
        list += name + '\0' + bytes_of(kFloat) + std::string(4, '\0');
        for (int step = 0; step < 2; ++step) list += bytes_of(std::int32_t{1});
    }
    return list + '\0';
}

// What every part of our files says.
void add_layout(ExrPart& part, const PartInfo& info, const Window& display) {
    const Window data{0, 0, info.width - 1, info.height - 1};
    part.attributes["name"] = exr_text(info.name);
    part.attributes["type"] = exr_text("scanlineimage");
    part.attributes["channels"] = {"chlist", channel_list(info)};
    part.attributes["compression"] = {"compression", bytes_of(kZip)};
    part.attributes["dataWindow"] = {"box2i", bytes_of(data)};
    part.attributes["displayWindow"] = {"box2i", bytes_of(display)};
    part.attributes["lineOrder"] = {"lineOrder", std::string(1, '\0')};
    part.attributes["pixelAspectRatio"] = exr_number(1.0f);
    part.attributes["screenWindowCenter"] = {"v2f", std::string(8, '\0')};
    part.attributes["screenWindowWidth"] = exr_number(1.0f);
    for (const auto& [name, text] : info.attributes) part.attributes[name] = exr_text(text);
}

}  // namespace

ExrAttribute exr_text(const std::string& text) { return {"string", text}; }
ExrAttribute exr_number(float value) { return {"float", bytes_of(value)}; }
ExrAttribute exr_number(double value) { return {"double", bytes_of(value)}; }
ExrAttribute exr_number(std::int32_t value) { return {"int", bytes_of(value)}; }

ByteSource bytes_in(std::string_view memory) {
    return {memory.size(), [memory](std::uint64_t at, std::span<char> to) {
                memory.copy(to.data(), to.size(), static_cast<std::size_t>(at));
            }};
}

ExrFile::ExrFile(ByteSource file) : bytes_(std::move(file)) {
    Reader bytes(bytes_);
    if (bytes_.size < 8 || bytes.number<std::uint32_t>() != kMagic)
        fail("this is no painting file: paintings are made by 'tangipaint fit' and end in .exr");
    several_ = (bytes.number<std::uint32_t>() & kSeveralParts) != 0;
    for (ExrPart part = next_part(bytes); !part.attributes.empty(); part = next_part(bytes)) {
        parts_.push_back(std::move(part));
        if (!several_) break;
    }
    for (ExrPart& part : parts_) {
        part.places.resize(blocks_of(part));
        for (std::uint64_t& place : part.places) place = bytes.number<std::uint64_t>();
    }
}

const ExrPart* ExrFile::part(const std::string& name) const {
    const auto found =
        std::find_if(parts_.begin(), parts_.end(), [&](const auto& p) { return p.text("name") == name; });
    return found == parts_.end() ? nullptr : &*found;
}

PartInfo ExrFile::info(const ExrPart& part) {
    PartInfo info;
    info.name = part.text("name");
    const auto window = part.get<Window>("dataWindow", {});
    info.width = window.x1 + 1, info.height = window.y1 + 1;
    if (window.x0 != 0 || window.y0 != 0 || info.width < 1 || info.height < 1 || info.width > kMostSide ||
        info.height > kMostSide)
        fail("the size of the painting's part '{}', {} x {}, cannot be right", info.name, info.width,
             info.height);
    if (packing_of(part) != kZip && packing_of(part) != kNotPacked)
        fail("the painting is packed in a way that only the desktop reads; save it there anew");
    const std::string list = part.text("channels");
    const ByteSource in_list = bytes_in(list);
    Reader bytes(in_list);
    for (std::string name; !(name = bytes.text()).empty();) {
        const auto type = bytes.number<std::uint32_t>();
        bytes.take(4);
        const bool whole = bytes.number<std::uint32_t>() == 1 && bytes.number<std::uint32_t>() == 1;
        if ((type != kFloat && type != kHalf) || !whole)
            fail("the painting's map '{}' is not as TangiPaint writes it", name);
        info.half = type == kHalf;
        info.channels.push_back(name);
    }
    for (const auto& [name, attribute] : part.attributes)
        if (attribute.type == "string") info.attributes[name] = attribute.bytes;
    return info;
}

ExrBlock ExrFile::block(const ExrPart& part, std::size_t number) const {
    Reader bytes(bytes_, part.places[number], kBlockHead);
    if (several_) bytes.number<std::uint32_t>();  // the part's number
    const auto y = bytes.number<std::int32_t>();
    const auto size = bytes.number<std::uint32_t>();
    if (y < 0 || y > part.get<Window>("dataWindow", {}).y1) fail("the painting file is damaged");
    return {y, bytes.take(size)};
}

void ExrFile::read(const ExrPart& part, const TakeRows& take) const {
    const PartInfo info = ExrFile::info(part);
    if (info.half) fail("part '{}' of the painting has numbers of 16 bits", info.name);
    const auto width = static_cast<std::size_t>(info.width), channels = info.channels.size();
    std::vector<float> values;
    for (std::size_t number = 0; number < part.places.size(); ++number) {
        ExrBlock packed = block(part, number);
        const int end = std::min(packed.y + rows_of_block(part), info.height);
        const auto rows = static_cast<std::size_t>(end - packed.y);
        const std::string lines = unpacked(std::move(packed.bytes), 4 * width * channels * rows);
        values.resize(width * channels * rows);
        std::vector<const float*> planes;
        for (std::size_t c = 0; c < channels; ++c) {
            for (std::size_t row = 0; row < rows; ++row)
                std::memcpy(&values[(c * rows + row) * width], &lines[4 * width * (row * channels + c)],
                            4 * width);
            planes.push_back(&values[c * rows * width]);
        }
        take(packed.y, end, planes);
    }
}

std::size_t block_count(const ExrSource& part) {
    if (part.from) return part.header.places.size();
    return static_cast<std::size_t>((part.rows.info.height + kExrRowsOfBlock - 1) / kExrRowsOfBlock);
}

std::string exr_head(const std::vector<ExrSource>& parts) {
    TP_REQUIRE(!parts.empty(), "a file has parts");
    // OpenEXR wants it to be the same for all parts, of whatever size.
    const PartInfo& first = parts.front().rows.info;
    const Window display = parts.front().from ? parts.front().header.get<Window>("displayWindow", {})
                                              : Window{0, 0, first.width - 1, first.height - 1};
    std::string head = bytes_of(kMagic) + bytes_of(kVersion | kSeveralParts);
    for (const ExrSource& part : parts) {
        ExrPart header = part.header;
        if (!part.from) add_layout(header, part.rows.info, display);
        header.attributes["chunkCount"] = exr_number(static_cast<std::int32_t>(block_count(part)));
        for (const auto& [name, attribute] : header.attributes)
            head += name + '\0' + attribute.type + '\0' +
                    bytes_of(static_cast<std::uint32_t>(attribute.bytes.size())) + attribute.bytes;
        head += '\0';
    }
    return head + '\0';
}

std::string exr_block(const ExrSource& part, std::size_t number, bool sorted) {
    const PartInfo& info = part.rows.info;
    const int y0 = static_cast<int>(number) * kExrRowsOfBlock,
              y1 = std::min(y0 + kExrRowsOfBlock, info.height);
    const auto width = static_cast<std::size_t>(info.width), rows = static_cast<std::size_t>(y1 - y0),
               channels = info.channels.size();
    std::vector<float> values(width * rows * channels);
    std::vector<float*> planes;
    for (std::size_t c = 0; c < channels; ++c) planes.push_back(&values[c * rows * width]);
    part.rows.fill(y0, y1, planes);
    std::string lines(4 * values.size(), '\0');
    for (std::size_t row = 0; row < rows; ++row)
        for (std::size_t c = 0; c < channels; ++c)
            std::memcpy(&lines[4 * width * (row * channels + c)], planes[c] + row * width, 4 * width);
    return sorted ? sorted_bytes(lines) : lines;
}

}  // namespace tangi
