#include "fit/light_checks/list_slips.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "capture/photo/photo_names.h"
#include "surface/base/median.h"
#include "surface/base/symmetric_matrix.h"

namespace tangi {

namespace {

constexpr std::size_t kShortestRow = 3;
constexpr double kLeastMean = 1e-3;  // [1] of a photograph's median: darker pixels have no relative change

// The names' order, as positions.
template <class Before>
ListOrdering sorted_by(const std::vector<Light>& lights, Before&& before) {
    ListOrdering order(lights.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return before(lights[a].name, lights[b].name); });
    return order;
}

// Photographs by letters and as counted: the k-th of the one order has the light of the k-th of the other.
ListOrdering by_names(bool letters, const std::vector<Light>& lights) {
    const ListOrdering lettered = sorted_by(lights, std::less<std::string>()),
                       counted = sorted_by(lights, before_as_counted);
    ListOrdering order(lights.size());
    for (std::size_t k = 0; k < lights.size(); ++k)
        letters ? order[counted[k]] = lettered[k] : order[lettered[k]] = counted[k];
    return order;
}

}  // namespace

std::size_t ListSlip::of(std::size_t i, std::size_t n) const {
    if (kind == Kind::snaked) {
        const std::size_t line = i / row, first = line * row, length = std::min(row, n - first);
        return line % 2 == 0 ? i : first + length - 1 - (i - first);
    }
    if (kind == Kind::columns) return i % row * (n / row) + i / row;
    if (kind == Kind::rows) return i % (n / row) * row + i / (n / row);
    if (i < from) return i;
    const auto count = static_cast<int>(n);
    const int at = (reversed ? count - 1 - static_cast<int>(i) : static_cast<int>(i)) + shift;
    return static_cast<std::size_t>(((at % count) + count) % count);
}

std::string_view name_of(ListSlip::Kind kind) {
    static constexpr std::string_view names[] = {"shifted", "snaked",  "columns",
                                                 "rows",    "letters", "counted"};
    return names[static_cast<std::size_t>(kind)];
}

ListOrdering ordering_of(const ListSlip& slip, const ListOrdering& sequence,
                         const std::vector<Light>& lights) {
    if (slip.kind == ListSlip::Kind::letters || slip.kind == ListSlip::Kind::counted)
        return by_names(slip.kind == ListSlip::Kind::letters, lights);
    ListOrdering order(sequence.size());
    for (std::size_t i = 0; i < sequence.size(); ++i)
        order[sequence[i]] = sequence[slip.of(i, sequence.size())];
    return order;
}

std::vector<ListSlip> list_slips(std::size_t photos) {
    using Kind = ListSlip::Kind;
    std::vector<ListSlip> slips;
    const auto n = static_cast<int>(photos);
    for (int shift = 1; 2 * shift <= n; ++shift)
        for (const int sign : {1, -1})
            if (2 * shift < n || sign > 0) slips.push_back({.shift = sign * shift});
    for (int shift = 0; shift < n; ++shift)
        slips.push_back({.shift = 2 * shift > n ? shift - n : shift, .reversed = true});
    for (std::size_t from = 2; from + 2 < photos; ++from)
        for (const int shift : {1, -1}) slips.push_back({.shift = shift, .from = from});
    for (std::size_t row = kShortestRow; 2 * row <= photos; ++row) {
        slips.push_back({.kind = Kind::snaked, .row = row});
        if (photos % row == 0)
            slips.push_back({.kind = Kind::columns, .row = row}),
                slips.push_back({.kind = Kind::rows, .row = row});
    }
    slips.push_back({.kind = Kind::letters});
    slips.push_back({.kind = Kind::counted});
    return slips;
}

ShadingChanges::ShadingChanges(const Survey& survey, const Transfer& transfer)
    : photos_(survey.photos.size()), covariance_(photos_ * photos_, 0) {
    const auto n = static_cast<Eigen::Index>(photos_);
    const auto samples = static_cast<Eigen::Index>(survey.sample_count());
    Eigen::MatrixXf changes(samples, n);
    for (Eigen::Index k = 0; k < samples; ++k) {
        const float* value = survey.sample(static_cast<int>(k));
        for (Eigen::Index i = 0; i < n; ++i) {
            float sum = 0;
            for (int c = 0; c < survey.channels; ++c) sum += transfer.decode(*value++);
            changes(k, i) = sum / static_cast<float>(survey.channels);
        }
    }
    for (Eigen::Index i = 0; i < n; ++i) {
        std::vector<float> known;
        for (const float value : changes.col(i))
            if (!std::isnan(value)) known.push_back(value);
        const float middle = known.empty() ? 0 : median(std::move(known));
        changes.col(i) /= std::max(middle, 1e-6f);
    }
    for (Eigen::Index k = 0; k < samples; ++k) {
        const float mean = changes.row(k).mean();
        // A highlight counts as much as a shadow.
        if (mean > static_cast<float>(kLeastMean))  // false where one is no number
            changes.row(k) = (changes.row(k).array() / mean - 1).cwiseMin(1.0f).cwiseMax(-1.0f).matrix();
        else
            changes.row(k).setZero();
    }
    Eigen::Map<Eigen::MatrixXd>(covariance_.data(), n, n) = (changes.transpose() * changes).cast<double>();
    for (std::size_t i = 0; i < photos_; ++i) all_ += covariance_[i * photos_ + i];
}

double ShadingChanges::explained(const std::vector<Light>& lights, const ListOrdering& order) const {
    if (!(all_ > 0)) return 0;
    const auto n = static_cast<Eigen::Index>(photos_);
    Eigen::MatrixXd basis(n, 3);
    for (Eigen::Index i = 0; i < n; ++i) {
        const Vec3& d = lights[order[static_cast<std::size_t>(i)]].direction;
        basis.row(i) << static_cast<double>(d.x), static_cast<double>(d.y), static_cast<double>(d.z);
    }
    basis.rowwise() -= basis.colwise().mean().eval();
    const Eigen::MatrixXd spanned = orthonormal_span(basis);  // lights of one ring span a plane alone
    const Eigen::Map<const Eigen::MatrixXd> covariance(covariance_.data(), n, n);
    return (spanned.transpose() * covariance * spanned).trace() / all_;
}

double ShadingChanges::by_any_three() const {
    if (!(all_ > 0)) return 0;
    const auto n = static_cast<Eigen::Index>(photos_);
    const Eigen::Map<const Eigen::MatrixXd> covariance(covariance_.data(), n, n);
    return symmetric_eigenvalues(covariance).tail(std::min<Eigen::Index>(3, n)).sum() / all_;
}

}  // namespace tangi
