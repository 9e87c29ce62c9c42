// stack_reader.cpp: bands of a stack: decoded, linearised, and resampled where a photograph was registered.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "capture/stack/photo_source.h"
#include "capture/stack/stack.h"
#include "capture/stack/survey.h"
#include "surface/base/error.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace {

constexpr int kLanczos = 3;    // [pixels] half the width of the kernel
constexpr int kPhases = 1024;  // of a pixel, for which the kernel is tabulated

double sinc(double x) {
    return std::abs(x) < 1e-9 ? 1 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x);
}

// Weights of the six neighbours from -2 to 3 at t in [0, 1] (Duchon 1979, "Lanczos filtering in one and two
// dimensions"), with the sum 1.
using LanczosTable = std::array<std::array<float, 2 * kLanczos>, kPhases + 1>;
LanczosTable make_lanczos_table() {
    LanczosTable table;
    for (int phase = 0; phase <= kPhases; ++phase) {
        std::array<double, 2 * kLanczos> w;
        double sum = 0;
        for (int i = 0; i < 2 * kLanczos; ++i) {
            const double x = static_cast<double>(phase) / kPhases - (i + 1 - kLanczos);
            w[static_cast<std::size_t>(i)] = std::abs(x) < kLanczos ? sinc(x) * sinc(x / kLanczos) : 0;
            sum += w[static_cast<std::size_t>(i)];
        }
        for (std::size_t i = 0; i < w.size(); ++i)
            table[static_cast<std::size_t>(phase)][i] = static_cast<float>(w[i] / sum);
    }
    return table;
}

void lanczos_weights(double t, float (&w)[2 * kLanczos]) {
    static const LanczosTable table = make_lanczos_table();
    const auto& row = table[static_cast<std::size_t>(t * kPhases + 0.5)];
    std::copy(row.begin(), row.end(), w);
}

}  // namespace

BandMemory::Values BandMemory::take(std::size_t count) {
    const std::lock_guard lock(mutex_);
    const auto fits = std::ranges::find_if(free_, [&](const auto& block) { return block.first >= count; });
    if (fits != free_.end()) {
        Values values(fits->second.release(), GiveBack{weak_from_this(), fits->first});
        free_.erase(fits);
        return values;
    }
    free_.clear();             // of a size that nobody asks for any more
    free_.reserve(++blocks_);  // so that giving back needs no memory
    return {std::make_unique_for_overwrite<float[]>(count).release(), GiveBack{weak_from_this(), count}};
}

void BandMemory::GiveBack::operator()(float* values) const noexcept {
    std::unique_ptr<float[]> owned(values);
    const std::shared_ptr<BandMemory> there = memory.lock();
    if (!there) return;
    const std::lock_guard lock(there->mutex_);
    there->free_.emplace_back(size, std::move(owned));
}

Band::Band(int photos, int channels, int width, int y0, int y1)
    : photos_(photos), channels_(channels), width_(width), y0_(y0), y1_(y1) {
    values_.reset(std::make_unique<float[]>(size()).release());
}

Band::Band(int photos, int channels, int width, int y0, int y1, BandMemory& memory)
    : photos_(photos), channels_(channels), width_(width), y0_(y0), y1_(y1) {
    values_ = memory.take(size());
}

Band Band::moved(int rows) && {
    y0_ += rows, y1_ += rows;
    return std::move(*this);
}

StackReader::StackReader(const Stack& stack) : stack_(stack), rows_(stack.photos.size()) {
    files_.reserve(stack.photos.size());
    for (const StackPhoto& photo : stack.photos) files_.emplace_back(stack, photo);
}

StackReader::~StackReader() = default;

long StackReader::without_number(std::size_t photo) const { return files_[photo].without_number(); }

long StackReader::transparent(std::size_t photo) const { return files_[photo].transparent(); }

int StackReader::rows_for(std::size_t bytes) const {
    const std::size_t row = sizeof(float) * files_.size() * static_cast<std::size_t>(stack_.channels) *
                            static_cast<std::size_t>(stack_.width());
    const std::size_t rows = std::min(bytes / row, static_cast<std::size_t>(stack_.height()));
    return std::max(static_cast<int>(rows), 1);
}

// Rows y0 <= y < y1 of the whole photograph. Those that the band before had are not decoded again.
const float* StackReader::rows_of(std::size_t photo, int y0, int y1) {
    PhotoSource& file = files_[photo];
    Rows& rows = rows_[photo];
    const auto row =
        static_cast<std::size_t>(file.header().width) * static_cast<std::size_t>(stack_.channels);
    if (y0 < rows.y0 || y0 > rows.y1) rows = {y0, y0, {}};
    rows.values.erase(rows.values.begin(),
                      rows.values.begin() + static_cast<std::ptrdiff_t>(row) * (y0 - rows.y0));
    rows.y0 = y0;
    if (y1 > rows.y1) {
        rows.values.resize(row * static_cast<std::size_t>(y1 - y0));
        file.read_rows(rows.y1, y1,
                       std::span(rows.values).subspan(row * static_cast<std::size_t>(rows.y1 - y0)));
        rows.y1 = y1;
    }
    return rows.values.data();
}

// Where pixels of a band lie in a photograph.
class StackReader::Placement {
public:
    Placement(const Stack& stack, std::size_t photo, const Band& band)
        : homography_(stack.photos[photo].homography.value_or(Homography(1))),
          geometry_(stack.geometry ? &*stack.geometry : nullptr),
          bends_(stack.geometry && stack.geometry->lens),
          x0_(stack.crop.x0),
          x1_(stack.crop.x0 + band.width()),
          y0_(stack.crop.y0 + band.y0()),
          y1_(stack.crop.y0 + band.y1()) {}

    // Of a pixel of the whole picture.
    glm::dvec2 operator()(double x, double y) const {
        const glm::dvec2 pixel = mapped(homography_, {x, y});
        return geometry_ ? geometry_->place_in_photo(pixel) : pixel;
    }
    // Rows of a photograph of this height that the band is made of. What is highest and lowest lies on the
    // band's border: of a homography at its corners, of a lens anywhere.
    std::pair<int, int> rows(int height) const {
        double lowest = height, highest = 0;
        const auto reach = [&](double x, double y) {
            const double row = (*this)(x, y).y;
            lowest = std::min(lowest, row);
            highest = std::max(highest, row);
        };
        for (int x = x0_; x < x1_; x += bends_ ? 1 : std::max(x1_ - x0_ - 1, 1))
            reach(x, y0_), reach(x, y1_ - 1);
        for (int y = y0_; y < y1_; y += bends_ ? 1 : std::max(y1_ - y0_ - 1, 1))
            reach(x0_, y), reach(x1_ - 1, y);
        const int first = std::clamp(static_cast<int>(std::floor(lowest)) - kLanczos, 0, height - 1);
        return {first, std::clamp(static_cast<int>(std::floor(highest)) + kLanczos + 2, first + 1, height)};
    }
    // The first row that the next band may need.
    int first_row_of_next() const {
        double next = std::min((*this)(x0_, y1_).y, (*this)(x1_ - 1, y1_).y);
        if (bends_)
            for (int x = x0_; x < x1_; ++x) next = std::min(next, (*this)(x, y1_).y);
        return static_cast<int>(std::floor(next)) - kLanczos - 1;
    }

private:
    Homography homography_;
    const PictureGeometry* geometry_;
    bool bends_;
    int x0_, x1_, y0_, y1_;
};

namespace {

// Rows of a photograph in linear light.
struct LinearRows {
    int width, height, channels;  // of the photograph
    int first, last;              // rows
    float clipped;
    std::vector<float> values;

    float at(int x, int y, int c) const {
        const int row = std::clamp(y, first, last - 1) - first;
        const std::size_t stride = static_cast<std::size_t>(width) * static_cast<std::size_t>(channels);
        return values[static_cast<std::size_t>(row) * stride +
                      static_cast<std::size_t>(std::clamp(x, 0, width - 1) * channels + c)];
    }
    bool holds(const glm::dvec2& p) const {
        return p.x >= 0 && p.y >= 0 && p.x <= width - 1 && p.y <= height - 1;
    }
    // By Lanczos' weights around pixel (px, py); of what is clipped, the highest value next to it.
    float interpolated(int px, int py, int c, const float (&wx)[2 * kLanczos],
                       const float (&wy)[2 * kLanczos]) const {
        const float near =
            std::max({at(px, py, c), at(px + 1, py, c), at(px, py + 1, c), at(px + 1, py + 1, c)});
        float sum = 0;
        for (int j = 0; j < 2 * kLanczos; ++j) {
            float row = 0;
            for (int i = 0; i < 2 * kLanczos; ++i)
                row += wx[i] * at(px + i + 1 - kLanczos, py + j + 1 - kLanczos, c);
            sum += wy[j] * row;
        }
        return near >= clipped ? near : std::max(sum, 0.0f);
    }
};

}  // namespace

template <class Decode>
void StackReader::resample(std::size_t photo, const Decode& decode, Band& band) {
    const Placement place(stack_, photo, band);
    const PhotoHeader& header = files_[photo].header();
    const int channels = stack_.channels;
    const auto [first, last] = place.rows(header.height);
    const float* stored = rows_of(photo, first, last);
    LinearRows rows{
        header.width,
        header.height,
        channels,
        first,
        last,
        stack_.development  ? stack_.development->clipped
        : stack_.bits == 32 ? std::numeric_limits<float>::infinity()
                            : decode(kClipped),
        std::vector<float>(static_cast<std::size_t>(header.width) * static_cast<std::size_t>(channels) *
                           static_cast<std::size_t>(last - first))};
    for (std::size_t i = 0; i < rows.values.size(); ++i) rows.values[i] = decode(stored[i]);
    float wx[2 * kLanczos], wy[2 * kLanczos];
    for (int y = band.y0(); y < band.y1(); ++y)
        for (int x = 0; x < band.width(); ++x) {
            const glm::dvec2 p = place(stack_.crop.x0 + x, stack_.crop.y0 + y);
            const bool inside = rows.holds(p);
            const int px = inside ? static_cast<int>(p.x) : 0, py = inside ? static_cast<int>(p.y) : 0;
            if (inside) lanczos_weights(p.x - px, wx), lanczos_weights(p.y - py, wy);
            for (int c = 0; c < channels; ++c)
                band.row(static_cast<int>(photo), c, y)[x] =
                    inside ? rows.interpolated(px, py, c, wx, wy) : std::numeric_limits<float>::quiet_NaN();
        }
    // Bands ascend: what the next one may share with this one stays, the rest need not be held.
    const int keep = std::clamp(place.first_row_of_next(), first, last);
    rows_of(photo, keep, keep);
    rows_[photo].values.shrink_to_fit();
}

void StackReader::take_transfer(const Transfer& transfer) {
    if (table_transfer_ && *table_transfer_ == transfer) return;
    const int codes = stack_.bits == 32 ? 0 : 1 << stack_.bits;  // floats have no table
    table_.resize(static_cast<std::size_t>(codes));
    for (int code = 0; code < codes; ++code)
        table_[static_cast<std::size_t>(code)] =
            transfer.decode(static_cast<float>(code) / static_cast<float>(codes - 1));
    table_transfer_ = transfer;
}

// Rows of a photograph that lies where it is.
template <class Decode>
void StackReader::read_photo(std::size_t photo, const Decode& decode, std::vector<float>& stored,
                             Band& band) {
    PhotoSource& file = files_[photo];
    const int channels = stack_.channels, width = band.width();
    const auto row = static_cast<std::size_t>(file.header().width) * static_cast<std::size_t>(channels);
    stored.resize(row * static_cast<std::size_t>(band.y1() - band.y0()));
    file.read_rows(stack_.crop.y0 + band.y0(), stack_.crop.y0 + band.y1(), stored);
    const float scale = static_cast<float>(static_cast<int>(table_.size()) - 1);
    for (int y = band.y0(); y < band.y1(); ++y) {
        const float* source =
            &stored[row * static_cast<std::size_t>(y - band.y0())] + stack_.crop.x0 * channels;
        for (int c = 0; c < channels; ++c) {
            float* target = band.row(static_cast<int>(photo), c, y);
            if (stack_.development || table_.empty()) {
                for (int x = 0; x < width; ++x) target[x] = decode(source[x * channels + c]);
                continue;
            }
            const float* table = table_.data();
            for (int x = 0; x < width; ++x) {
                const float value = source[x * channels + c];
                target[x] = std::isnan(value) ? value : table[static_cast<int>(value * scale + 0.5f)];
            }
        }
    }
}

Band StackReader::read(int y0, int y1, const Transfer& transfer) {
    take_transfer(transfer);
    const float scale = static_cast<float>(static_cast<int>(table_.size()) - 1);
    const bool developed = stack_.development != nullptr;
    TP_REQUIRE(!developed || transfer == Transfer{}, "developed values are linear already");
    const auto decode = [&](float stored) {
        if (developed || std::isnan(stored)) return stored;  // no sample is no black
        return table_.empty() ? transfer.decode(stored)
                              : table_[static_cast<std::size_t>(stored * scale + 0.5f)];
    };
    const int photos = static_cast<int>(files_.size());
    Band band(photos, stack_.channels, stack_.width(), y0, y1, *memory_);
    parallel_for(0, photos, 1, [&](int begin, int end) {
        std::vector<float> stored;
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
            if (stack_.geometry || stack_.photos[i].homography)
                resample(i, decode, band);
            else
                read_photo(i, decode, stored, band);
        }
    });
    return band;
}

}  // namespace tangi
