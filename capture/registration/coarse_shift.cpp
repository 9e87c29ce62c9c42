#include "capture/registration/coarse_shift.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "surface/base/median.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace {

constexpr int kSize = 256;              // [pixels] longest side of what is correlated
constexpr double kBetter = 1.3;         // [1] correlation at the shift against that at none
constexpr double kLeast = 0.1;          // [1] correlation at the shift
constexpr double kLeastShift = 1.5;     // [pixels of what is correlated]
constexpr double kFarthestShift = 0.3;  // [1] of the side
// That each picture is laid onto: one or two may be of something else.
constexpr std::size_t kNeighboursLaidOnto = 4;

cv::Mat spectrum_of(const Image<float>& picture, int reduction, const cv::Size& size) {
    cv::Mat whole(picture.height(), picture.width(), CV_32F, const_cast<float*>(picture.data())), small;
    if (!cv::checkRange(whole)) {  // no sample: no contrast
        whole = whole.clone();
        cv::patchNaNs(whole, 0);
    }
    cv::resize(whole, small, {picture.width() / reduction, picture.height() / reduction}, 0, 0,
               cv::INTER_AREA);
    cv::Mat window, padded = cv::Mat::zeros(size, CV_32F), spectrum;
    cv::createHanningWindow(window, small.size(), CV_32F);
    small = small.mul(window);
    small.copyTo(padded(cv::Rect({0, 0}, small.size())));
    cv::dft(padded, spectrum);
    return spectrum;
}

// How one picture lies on another.
struct Link {
    glm::dvec2 shift{0};  // [pixels of what is correlated] 0 where none is much better than none
    double quality = 0;   // [1] correlation at this shift
};

// Pictures as spectra, and links between them as they are asked for.
class Spectra {
public:
    Spectra(const std::vector<Image<float>>& pictures, int reduction) : spectra_(pictures.size()) {
        farthest_ = kFarthestShift * glm::dvec2(pictures.front().width(), pictures.front().height()) /
                    static_cast<double>(reduction);
        size_ = {cv::getOptimalDFTSize(2 * (pictures.front().width() / reduction)),
                 cv::getOptimalDFTSize(2 * (pictures.front().height() / reduction))};
        parallel_for(0, static_cast<int>(pictures.size()), 1, [&](int begin, int end) {
            for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
                spectra_[i] = spectrum_of(pictures[i], reduction, size_);
        });
        for (std::size_t i = 0; i < pictures.size(); ++i) energy_.push_back(correlated(i, i).at<float>(0, 0));
    }

    Link link(std::size_t a, std::size_t b) const {
        const cv::Mat map = correlated(a, b);
        const double norm = std::sqrt(energy_[a] * energy_[b]), still = map.at<float>(0, 0);
        if (!(norm > 0)) return {};
        double peak;
        cv::Point at;
        cv::minMaxLoc(map, nullptr, &peak, nullptr, &at);
        const glm::dvec2 shift(at.x > size_.width / 2 ? at.x - size_.width : at.x,
                               at.y > size_.height / 2 ? at.y - size_.height : at.y);
        const bool believed = peak > kLeast * norm && peak > kBetter * std::max(still, 0.0) &&
                              glm::length(shift) >= kLeastShift && std::abs(shift.x) < farthest_.x &&
                              std::abs(shift.y) < farthest_.y;
        if (believed) return {shift, peak / norm};
        return {glm::dvec2(0), still / norm};
    }

private:
    cv::Mat correlated(std::size_t a, std::size_t b) const {
        cv::Mat product, map;
        cv::mulSpectrums(spectra_[a], spectra_[b], product, 0, true);
        cv::dft(product, map, cv::DFT_INVERSE | cv::DFT_REAL_OUTPUT | cv::DFT_SCALE);
        return map;
    }

    std::vector<cv::Mat> spectra_;
    std::vector<double> energy_;
    cv::Size size_;
    glm::dvec2 farthest_{0};
};

// The pictures in the model that are lit most like one, itself left out.
std::vector<std::size_t> neighbours(std::size_t of, const std::vector<glm::dvec3>& lights,
                                    const std::vector<bool>& in_model) {
    std::vector<std::size_t> others;
    for (std::size_t i = 0; i < lights.size(); ++i)
        if (i != of && in_model[i]) others.push_back(i);
    const auto count = static_cast<std::ptrdiff_t>(std::min<std::size_t>(kNeighboursLaidOnto, others.size()));
    std::partial_sort(
        others.begin(), others.begin() + count, others.end(), [&](std::size_t a, std::size_t b) {
            const double da = glm::length(lights[a] - lights[of]), db = glm::length(lights[b] - lights[of]);
            return da != db ? da < db : a < b;
        });
    others.resize(static_cast<std::size_t>(count));
    return others;
}

struct Edge {
    std::size_t a = 0, b = 0;
    Link link;  // what moves a onto b
};

// Each picture with its neighbours.
std::vector<Edge> edges_between(const Spectra& spectra, const std::vector<glm::dvec3>& lights,
                                const std::vector<bool>& in_model) {
    std::vector<Edge> edges;
    for (std::size_t i = 0; i < lights.size(); ++i)
        for (const std::size_t j : neighbours(i, lights, in_model)) edges.push_back({i, j, {}});
    parallel_for(0, static_cast<int>(edges.size()), 1, [&](int begin, int end) {
        for (int k = begin; k < end; ++k) {
            Edge& edge = edges[static_cast<std::size_t>(k)];
            edge.link = spectra.link(edge.a, edge.b);
        }
    });
    return edges;
}

// From the pictures that are done to one that is not, where no edge leads: between the most similar lights.
Edge bridge(const Spectra& spectra, const std::vector<glm::dvec3>& lights, const std::vector<bool>& in_model,
            const std::vector<bool>& done) {
    Edge nearest;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t a = 0; a < lights.size(); ++a)
        for (std::size_t b = 0; b < lights.size(); ++b)
            if (const double d = glm::length(lights[a] - lights[b]);
                !done[a] && done[b] && in_model[b] && d < least)
                least = d, nearest = {a, b, {}};
    nearest.link = spectra.link(nearest.a, nearest.b);
    return nearest;
}

// [pixels of what is correlated] of each picture against `root`, along the best links.
std::vector<glm::dvec2> shifts_along_tree(const std::vector<Edge>& edges, std::size_t root,
                                          const Spectra& spectra, const std::vector<glm::dvec3>& lights,
                                          const std::vector<bool>& in_model) {
    std::vector<glm::dvec2> shifts(lights.size(), glm::dvec2(0));
    std::vector<bool> done(lights.size(), false);
    done[root] = true;
    for (std::size_t step = 1; step < lights.size(); ++step) {
        std::optional<Edge> next;
        for (const Edge& edge : edges) {
            // Pictures without a say in the model lead nowhere.
            const bool leads =
                (done[edge.b] && !done[edge.a]) || (done[edge.a] && !done[edge.b] && in_model[edge.a]);
            if (leads && (!next || edge.link.quality > next->link.quality)) next = edge;
        }
        if (!next) next = bridge(spectra, lights, in_model, done);
        if (done[next->b])
            shifts[next->a] = shifts[next->b] + next->link.shift, done[next->a] = true;
        else
            shifts[next->b] = shifts[next->a] - next->link.shift, done[next->b] = true;
    }
    return shifts;
}

}  // namespace

std::vector<glm::dvec2> coarse_shifts(const std::vector<Image<float>>& pictures,
                                      const std::vector<glm::dvec3>& lights,
                                      const std::vector<bool>& in_model) {
    const std::size_t count = pictures.size();
    const int width = pictures.front().width(), height = pictures.front().height();
    const int reduction = std::max(1, (std::max(width, height) + kSize - 1) / kSize);
    if (std::min(width, height) / reduction < 16 ||
        std::find(in_model.begin(), in_model.end(), true) == in_model.end())
        return std::vector<glm::dvec2>(count, glm::dvec2(0));
    const Spectra spectra(pictures, reduction);
    const std::vector<Edge> edges = edges_between(spectra, lights, in_model);
    std::vector<double> best(count, 0);  // how well each lies on its neighbours
    for (const Edge& edge : edges) {
        best[edge.a] = std::max(best[edge.a], edge.link.quality);
        best[edge.b] = std::max(best[edge.b], edge.link.quality);
    }
    std::vector<double> all;
    std::size_t root = count;
    for (std::size_t i = 0; i < count; ++i) {
        if (!in_model[i]) continue;
        all.push_back(best[i]);
        if (root == count || best[i] > best[root]) root = i;
    }
    std::vector<glm::dvec2> shifts = shifts_along_tree(edges, root, spectra, lights, in_model);
    // The frame is that of the first picture that lies at least half as well on others as most do.
    const double usual = median(std::move(all));
    std::size_t first = 0;
    while (!in_model[first] || best[first] < usual / 2) ++first;
    const glm::dvec2 of_first = shifts[first];
    for (glm::dvec2& shift : shifts) shift = static_cast<double>(reduction) * (shift - of_first);
    return shifts;
}

}  // namespace tangi
