#include "fit/exchange/ptm_rti_file.h"

#include <array>
#include <cmath>
#include <cstring>
#include <sstream>

#include "surface/base/error.h"
#include "surface/base/json_text.h"
#include "surface/image_file/image_io.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr int kLargestSide_px = 1 << 20;  // of a side
constexpr std::size_t kSampled = 1u << 20;

// How bytes stand for the coefficients of one term: low + byte / 255 * (high - low).
struct Range {
    float low = 0, high = 0;
};

// In a .ptm the bias is a whole number of steps, and many readers take it for a byte: 0 lies in the range.
Range rounded_for_ptm(Range r) {
    const float step = (r.high - r.low) / 255;
    const float bias = std::round(-r.low / step);
    return {-bias * step, (255 - bias) * step};
}

double squared_error(const std::vector<float>& values, const Range& r) {
    const float step = (r.high - r.low) / 255;
    double sum = 0;
    for (const float v : values) {
        const float byte = std::clamp(std::round((v - r.low) / step), 0.0f, 255.0f);
        const double e = r.low + byte * step - v;
        sum += e * e;
    }
    return sum;
}

// Of all channels; `with_zero` keeps 0 in it.
Range range_of(const RtiImage& image, int term, bool with_zero) {
    const auto terms = static_cast<std::size_t>(terms_of(image.basis));
    const std::size_t count = image.coefficients.size() / terms,
                      step = std::max<std::size_t>(count / kSampled, 1);
    std::vector<float> values;
    for (std::size_t i = 0; i < count; i += step)
        values.push_back(image.coefficients[i * terms + static_cast<std::size_t>(term)]);
    std::sort(values.begin(), values.end());
    Range best;
    double least = -1;
    for (const double part : {0.0, 1e-5, 1e-4, 5e-4, 2e-3, 1e-2}) {
        const auto cut = static_cast<std::size_t>(part * static_cast<double>(values.size() - 1));
        Range r{values[cut], values[values.size() - 1 - cut]};
        if (with_zero) r = {std::min(r.low, 0.0f), std::max(r.high, 0.0f)};
        if (!(r.high - r.low > 1e-9f)) r.high = r.low + 1e-6f;
        if (with_zero) r = rounded_for_ptm(r);
        if (const double error = squared_error(values, r); least < 0 || error < least) {
            least = error;
            best = r;
        }
    }
    return best;
}

std::vector<Range> ranges_of(const RtiImage& image, bool with_zero) {
    std::vector<Range> ranges;
    for (int t = 0; t < terms_of(image.basis); ++t) ranges.push_back(range_of(image, t, with_zero));
    return ranges;
}

// Appends the bytes of one channel of one pixel.
void append(std::string& bytes, const RtiImage& image, std::size_t pixel, int channel,
            std::span<const Range> ranges) {
    const float* c =
        &image.coefficients[pixel * image.stride() + static_cast<std::size_t>(channel) * ranges.size()];
    for (std::size_t t = 0; t < ranges.size(); ++t) {
        const Range& r = ranges[t];
        const float byte = std::round(255 * (c[t] - r.low) / (r.high - r.low));
        bytes.push_back(static_cast<char>(static_cast<unsigned char>(std::clamp(byte, 0.0f, 255.0f))));
    }
}

std::string ptm_bytes(const RtiImage& image, const Progress& progress) {
    const std::vector<Range> ranges = ranges_of(image, true);
    std::string scales, biases;
    for (const Range& r : ranges) {
        const float step = (r.high - r.low) / 255;
        scales += fmt::format("{}{:.9g}", scales.empty() ? "" : " ", 255 * step);
        biases += fmt::format("{}{}", biases.empty() ? "" : " ", std::lround(-r.low / step));
    }
    std::string bytes =
        fmt::format("PTM_1.2\n{}\n{}\n{}\n{}\n{}\n", image.lrgb ? "PTM_FORMAT_LRGB" : "PTM_FORMAT_RGB",
                    image.width, image.height, scales, biases);
    const auto each_pixel = [&](auto&& body) {
        for (int y = image.height - 1; y >= 0; --y)
            for (int x = 0; x < image.width; ++x)
                body(static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                     static_cast<std::size_t>(x));
    };
    for (int c = 0; c < image.channels(); ++c) {
        each_pixel([&](std::size_t pixel) { append(bytes, image, pixel, c, ranges); });
        report(progress, "write ptm", (c + 1.0) / image.channels());
    }
    if (image.lrgb)
        each_pixel([&](std::size_t pixel) {
            for (int c = 0; c < 3; ++c)
                bytes.push_back(static_cast<char>(static_cast<unsigned char>(
                    std::lround(255 * std::clamp(image.colour.pixels()[pixel][c], 0.0f, 1.0f)))));
        });
    return bytes;
}

std::string rti_bytes(const RtiImage& image, const Progress& progress) {
    const std::vector<Range> ranges = ranges_of(image, false);
    std::string bytes =
        fmt::format("#HSH1.2\n3\n{} {} 3\n{} 2 1\n", image.width, image.height, terms_of(image.basis));
    const auto append_float = [&](float value) {
        char four[4];
        std::memcpy(four, &value, 4);
        bytes.append(four, 4);
    };
    for (const Range& r : ranges) append_float(r.high - r.low);
    for (const Range& r : ranges) append_float(r.low);
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x)
            for (int c = 0; c < 3; ++c)
                append(bytes, image,
                       static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                           static_cast<std::size_t>(x),
                       c, ranges);
        if (y % 64 == 0) report(progress, "write rti", y / static_cast<double>(image.height));
    }
    return bytes;
}

// Reads the words and lines of a header, then bytes.
class Reader {
public:
    Reader(const fs::path& path, const std::string& bytes) : path_(path), bytes_(bytes) {}

    std::string line() {
        const std::size_t end = bytes_.find('\n', at_);
        if (end == std::string::npos || end - at_ > 1000) fail("{}: its header is damaged", path_.string());
        std::string text = bytes_.substr(at_, end - at_);
        at_ = end + 1;
        if (!text.empty() && text.back() == '\r') text.pop_back();
        return text;
    }
    // As many numbers as asked for, on one line or several.
    std::vector<double> numbers(std::size_t count, const char* what) {
        std::vector<double> values;
        while (values.size() < count) {
            std::istringstream words(line());
            for (std::string word; words >> word;) {
                char* end = nullptr;
                values.push_back(std::strtod(word.c_str(), &end));
                if (*end || !std::isfinite(values.back()))
                    fail("{}: '{}' in its header is no {}", path_.string(), shortened(word), what);
            }
        }
        if (values.size() > count) fail("{}: its header has more than {} {}", path_.string(), count, what);
        return values;
    }
    std::pair<int, int> size(double width, double height) const {
        for (const double side : {width, height})
            if (!(side >= 1 && side <= kLargestSide_px && side == std::floor(side)))
                fail("{}: it says it is {} x {} pixels", path_.string(), width, height);
        return {static_cast<int>(width), static_cast<int>(height)};
    }
    // All that is left; its size must be as expected.
    std::span<const unsigned char> rest(std::size_t expected) const {
        const std::size_t there = bytes_.size() - at_;
        if (there < expected)
            fail("{}: is cut off: {} bytes of {} are there", path_.string(), there, expected);
        return {reinterpret_cast<const unsigned char*>(bytes_.data()) + at_, expected};
    }
    float number() {
        float value = 0;
        std::memcpy(&value, rest(sizeof value).data(), sizeof value);
        at_ += sizeof value;
        if (!std::isfinite(value)) fail("{}: its scales and biases are damaged", path_.string());
        return value;
    }

private:
    const fs::path& path_;
    const std::string& bytes_;
    std::size_t at_ = 0;
};

RtiImage sized(RtiBasis basis, bool lrgb, std::pair<int, int> size) {
    return {basis, lrgb, size.first, size.second, {}, {}};
}

RtiImage ptm_of(const fs::path& path, Reader& reader) {
    const std::string format = reader.line();
    const bool lrgb = format == "PTM_FORMAT_LRGB";
    if (!lrgb && format != "PTM_FORMAT_RGB")
        fail("{}: is of the format {}; only PTM_FORMAT_RGB and PTM_FORMAT_LRGB, uncompressed, are read",
             path.string(), shortened(format));
    const auto sides = reader.numbers(2, "size");
    RtiImage image = sized(RtiBasis::ptm, lrgb, reader.size(sides[0], sides[1]));
    const auto scales = reader.numbers(6, "scale"), biases = reader.numbers(6, "bias");
    const std::size_t pixels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    const auto bytes = reader.rest(pixels * (lrgb ? 9 : 18));
    image.coefficients.resize(pixels * image.stride());
    if (lrgb) image.colour = Image<Rgb>(image.width, image.height);
    const auto width = static_cast<std::size_t>(image.width), height = static_cast<std::size_t>(image.height);
    for (std::size_t y = 0; y < height; ++y)
        for (std::size_t x = 0; x < width; ++x) {
            const std::size_t pixel = (height - 1 - y) * width + x, at = y * width + x;
            for (std::size_t c = 0; c < static_cast<std::size_t>(image.channels()); ++c)
                for (std::size_t t = 0; t < 6; ++t)
                    image.coefficients[pixel * image.stride() + c * 6 + t] =
                        static_cast<float>((bytes[(c * pixels + at) * 6 + t] - biases[t]) * scales[t] / 255);
            if (lrgb)
                for (std::size_t c = 0; c < 3; ++c)
                    image.colour.pixels()[pixel][static_cast<int>(c)] =
                        bytes[6 * pixels + at * 3 + c] / 255.0f;
        }
    return image;
}

RtiImage hsh_of(const fs::path& path, Reader& reader) {
    const auto kind = reader.numbers(1, "kind");
    if (kind[0] != 3)
        fail("{}: is an .rti file of kind {}; only 3, harmonics, is read", path.string(), kind[0]);
    const auto sides = reader.numbers(3, "size"), layout = reader.numbers(3, "layout");
    const auto basis = layout[0] == 4    ? std::optional(RtiBasis::hsh4)
                       : layout[0] == 9  ? std::optional(RtiBasis::hsh9)
                       : layout[0] == 16 ? std::optional(RtiBasis::hsh16)
                                         : std::nullopt;
    if (!basis || sides[2] != 3 || layout[1] != 2 || layout[2] != 1)
        fail(
            "{}: has {} terms of {} channels, type {}, {} bytes each; only 4, 9 or 16 of 3, type 2, 1 byte, "
            "are read",
            path.string(), layout[0], sides[2], layout[1], layout[2]);
    RtiImage image = sized(*basis, false, reader.size(sides[0], sides[1]));
    const auto terms = static_cast<std::size_t>(terms_of(*basis));
    std::vector<float> scales(terms), biases(terms);
    for (float& scale : scales) scale = reader.number();
    for (float& bias : biases) bias = reader.number();
    const std::size_t count =
        static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * image.stride();
    const auto bytes = reader.rest(count);
    image.coefficients.resize(count);
    for (std::size_t i = 0; i < count; ++i)
        image.coefficients[i] = static_cast<float>(bytes[i]) / 255 * scales[i % terms] + biases[i % terms];
    return image;
}

}  // namespace

void write_rti_file(AtomicFile& file, const RtiImage& image, const Progress& progress) {
    TP_REQUIRE(image.width > 0 && image.height > 0, "an image has pixels");
    const std::string extension = lower_extension(file.target());
    const bool ptm = image.basis == RtiBasis::ptm;
    if (extension != (ptm ? ".ptm" : ".rti") || (!ptm && image.lrgb))
        fail("{}: {} is written to a file {}", file.target().string(), name_of(image.basis),
             ptm ? ".ptm" : ".rti, with coefficients for each channel");
    file.write(ptm ? ptm_bytes(image, progress) : rti_bytes(image, progress));
    file.commit();
}

RtiImage read_rti_file(const fs::path& path) {
    const std::string bytes = read_text_file(path);
    Reader reader(path, bytes);
    const std::string magic = bytes.substr(0, 7);
    if (magic != "PTM_1.2" && magic != "#HSH1.2")
        fail("{}: is no .ptm of version 1.2 and no .rti of harmonics (#HSH1.2)", path.string());
    reader.line();
    return magic == "PTM_1.2" ? ptm_of(path, reader) : hsh_of(path, reader);
}

}  // namespace tangi
