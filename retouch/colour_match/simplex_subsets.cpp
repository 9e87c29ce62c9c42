#include "retouch/colour_match/simplex_subsets.h"

#include <algorithm>
#include <cmath>

#include "surface/base/error.h"

namespace tangi {

namespace {

// With G = L L^T, the minimum over sum c = 1 is c = G^-1 1 / (1^T G^-1 1), its cost 1 / |y|^2 with L y = 1:
// a column more is a row of L more, so subsets share the work of those that they begin with.
class Search {
public:
    Search(std::span<const double> gram, int n, int at_most, std::size_t keep, std::span<const char> allowed)
        : gram_(gram), allowed_(allowed), n_(n), at_most_(at_most), keep_(keep) {
        for (int i = 0; i < n; ++i) scale_ += at(i, i) / n;
        extend(0, 0, 0);
        std::sort_heap(best_.begin(), best_.end(), before);
    }
    std::vector<SubsetFit> take() { return std::move(best_); }

private:
    double at(int i, int j) const { return gram_[static_cast<std::size_t>(i * n_ + j)]; }
    bool may_join(int column, int size) const {
        return allowed_.empty() || std::all_of(columns_, columns_ + size, [&](int other) {
                   return allowed_[static_cast<std::size_t>(other * n_ + column)] != 0;
               });
    }
    static bool before(const SubsetFit& a, const SubsetFit& b) {
        return a.cost != b.cost ? a.cost < b.cost : a.columns < b.columns;
    }

    void extend(int size, int first, double yy) {
        if (size >= at_most_ || size >= kMostPaints) return;
        for (int column = first; column < n_; ++column) {
            if (!may_join(column, size)) continue;
            double rest = at(column, column) * (1 + 1e-12) + 1e-12 * scale_;
            double right = 1;
            for (int i = 0; i < size; ++i) {
                double v = at(column, columns_[i]);
                for (int j = 0; j < i; ++j) v -= l_[size][j] * l_[i][j];
                l_[size][i] = v / l_[i][i];
                rest -= l_[size][i] * l_[size][i];
                right -= l_[size][i] * y_[i];
            }
            // Columns that depend on those before say nothing new.
            if (!(rest > 1e-12 * at(column, column))) continue;
            l_[size][size] = std::sqrt(rest);
            y_[size] = right / l_[size][size];
            columns_[size] = column;
            const double sum = yy + y_[size] * y_[size];
            consider(size + 1, sum);
            extend(size + 1, column + 1, sum);
        }
    }

    void consider(int size, double yy) {
        const double cost = 1 / yy;
        if (best_.size() == keep_ && cost >= best_.front().cost) return;
        SubsetFit fit;
        fit.count = size;
        fit.cost = cost;
        for (int i = size - 1; i >= 0; --i) {
            double c = y_[i];
            for (int j = i + 1; j < size; ++j) c -= l_[j][i] * fit.weights[static_cast<std::size_t>(j)];
            c /= l_[i][i];
            if (!(c > 1e-9 * yy)) return;
            fit.weights[static_cast<std::size_t>(i)] = c;
            fit.columns[static_cast<std::size_t>(i)] = columns_[i];
        }
        for (double& c : fit.weights) c /= yy;
        best_.push_back(fit);
        std::push_heap(best_.begin(), best_.end(), before);
        if (best_.size() <= keep_) return;
        std::pop_heap(best_.begin(), best_.end(), before);
        best_.pop_back();
    }

    std::span<const double> gram_;
    std::span<const char> allowed_;
    int n_, at_most_;
    std::size_t keep_;
    double scale_ = 0;
    int columns_[kMostPaints] = {};
    double l_[kMostPaints][kMostPaints] = {}, y_[kMostPaints] = {};
    std::vector<SubsetFit> best_;
};

}  // namespace

std::vector<SubsetFit> best_subsets(std::span<const double> gram, int n, int at_most, std::size_t keep,
                                    std::span<const char> allowed) {
    TP_REQUIRE(n > 0 && gram.size() == static_cast<std::size_t>(n) * static_cast<std::size_t>(n),
               "the matrix is square");
    TP_REQUIRE(allowed.empty() || allowed.size() == gram.size(), "a word for every pair");
    TP_REQUIRE(at_most >= 1 && at_most <= kMostPaints && keep > 0, "a few columns");
    return Search(gram, n, at_most, keep, allowed).take();
}

}  // namespace tangi
