// alignment_unexplained.cpp: what three terms of the light leave unexplained where pictures lie as they do.
#include <cmath>

#include "capture/registration/alignment.h"
#include "surface/base/median.h"
#include "surface/base/parallel.h"

namespace tangi {

double Alignment::unexplained() {
    sample();
    std::vector<double> left(pixels_.size(), 0);
    parallel_for(0, static_cast<int>(pixels_.size()), 64, [&](int begin, int end) {
        for (auto k = static_cast<std::size_t>(begin); k < static_cast<std::size_t>(end); ++k) {
            const Sample* s = &samples_[k * pictures.size()];
            Small a{};
            Three b{};
            std::vector<std::size_t> seen;
            for (std::size_t i = 0; i < pictures.size(); ++i) {
                if (std::isnan(s[i].value) || !in_model_[i]) continue;
                const Three& f = terms_of_[i];
                for (std::size_t p = 0; p < 3; ++p) {
                    for (std::size_t q = 0; q <= p; ++q) a[p][q] += f[p] * f[q];
                    b[p] += f[p] * static_cast<double>(s[i].value);
                }
                seen.push_back(i);
            }
            if (seen.size() <= 3 || !factorise(a, 3)) continue;
            solve(a, 3, b);
            double squares = 0;
            for (const std::size_t i : seen) {
                const double r = static_cast<double>(s[i].value) - dot(b, terms_of_[i], 3);
                squares += r * r;
            }
            left[k] = std::sqrt(squares / static_cast<double>(seen.size() - 3));
        }
    });
    std::erase(left, 0.0);
    return left.empty() ? 0 : median(std::move(left));
}

}  // namespace tangi
