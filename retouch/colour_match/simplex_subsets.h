// simplex_subsets.h: which few of many columns mix to nearly nothing: the non-negative least squares of
// recipes, solved for all small subsets.
#pragma once

#include <array>
#include <span>
#include <vector>

namespace tangi {

inline constexpr int kMostPaints = 4;  // of one recipe

struct SubsetFit {
    std::array<int, kMostPaints> columns{};
    std::array<double, kMostPaints> weights{};  // > 0 for the first `count`, sum 1
    int count = 0;
    double cost = 0;  // |A c|^2
};

// Minimises |A c|^2 with c >= 0, sum c = 1, for every subset of at most `at_most` (1..kMostPaints) columns;
// `gram` is A^T A, n x n, row by row. Gives the `keep` subsets with the least cost, best first, ties in the
// order of their columns. A subset whose minimum lies at the rim (a weight would be negative) is rejected:
// there, a smaller one is as good. So the first is the global minimum over all mixtures of at most `at_most`
// columns, as Lawson & Hanson's (1974) active set would find it for each subset alone. `allowed`, n x n:
// pairs of columns that may come together (0: not); all where it is empty.
std::vector<SubsetFit> best_subsets(std::span<const double> gram, int n, int at_most, std::size_t keep,
                                    std::span<const char> allowed = {});

}  // namespace tangi
