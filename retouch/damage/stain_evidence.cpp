#include "retouch/damage/stain_evidence.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace tangi {

namespace {

constexpr float kOtherPaint = 0.03f;  // weight of a step to another paint, which is taken for none
constexpr float kOther = 0.3f, kLeastStep = 0.03f;  // of the law: what goes beside it counts less
constexpr float kMostStep = 0.5f;                   // of ln, from block to block: more is an edge
constexpr float kScreening = 1e-4f;                 // per block^2: levels are told within some 100 blocks
constexpr int kMostRounds = 400;

// A step from each block to the next, to the right or down: [1] its weight and how much light it loses.
struct Steps {
    cv::Mat weight, loss;
};

Steps steps_to(const AreaFeatures& f, const cv::Point& to) {
    const cv::Size size = f.measured.size();
    Steps steps{cv::Mat::zeros(size, CV_32F), cv::Mat::zeros(size, CV_32F)};
    for (int y = 0; y + to.y < size.height; ++y)
        for (int x = 0; x + to.x < size.width; ++x) {
            const cv::Point here(x, y), there = here + to;
            if (!f.measured.at<unsigned char>(here) || !f.measured.at<unsigned char>(there)) continue;
            float along = 0, squares = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                const cv::Mat& m = f.maps[static_cast<std::size_t>(Cue::red) + c];
                const float step = m.at<float>(here) - m.at<float>(there);
                along += static_cast<float>(kStainLaw[c]) * step;
                squares += step * step;
            }
            const float beside = std::max(squares - along * along, 0.0f),
                        allowed = kOther * std::abs(along) + kLeastStep;
            if (std::abs(along) > kMostStep) continue;
            const float same =
                within_paint(f, std::max(f.gloss_range.at<float>(here), f.gloss_range.at<float>(there)));
            const float lawful = 1 / (1 + beside / (allowed * allowed));
            steps.weight.at<float>(here) = std::max(same * lawful, kOtherPaint);
            steps.loss.at<float>(here) = same * lawful * along;
        }
    return steps;
}

// Weighted least squares by conjugate gradients: steps as they are, levels drawn to 0.
class Summation {
public:
    Summation(const Steps& right, const Steps& down) : right_(right), down_(down) {}

    cv::Mat solve() const {
        const cv::Mat b = right_side();
        cv::Mat x = cv::Mat::zeros(b.size(), CV_32F), r = b.clone(), diagonal = diagonal_of(), z, q;
        z = r / diagonal;
        cv::Mat p = z.clone();
        double rz = r.dot(z);
        const double enough = 1e-6 * rz;
        for (int round = 0; round < kMostRounds && rz > enough; ++round) {
            q = times(p);
            const double step = rz / p.dot(q);
            x += step * p;
            r -= step * q;
            z = r / diagonal;
            const double next = r.dot(z);
            p = z + (next / rz) * p;
            rz = next;
        }
        return x;
    }

private:
    template <class Use>
    void each(const Use& use) const {
        for (int y = 0; y < right_.weight.rows; ++y)
            for (int x = 0; x < right_.weight.cols; ++x) {
                const cv::Point here(x, y);
                if (right_.weight.at<float>(here) > 0) use(right_, here, here + cv::Point(1, 0));
                if (down_.weight.at<float>(here) > 0) use(down_, here, here + cv::Point(0, 1));
            }
    }
    cv::Mat right_side() const {
        cv::Mat b = cv::Mat::zeros(right_.weight.size(), CV_32F);
        each([&](const Steps& s, const cv::Point& here, const cv::Point& there) {
            b.at<float>(there) += s.loss.at<float>(here);
            b.at<float>(here) -= s.loss.at<float>(here);
        });
        return b;
    }
    cv::Mat diagonal_of() const {
        cv::Mat d(right_.weight.size(), CV_32F, cv::Scalar(kScreening));
        each([&](const Steps& s, const cv::Point& here, const cv::Point& there) {
            d.at<float>(there) += s.weight.at<float>(here);
            d.at<float>(here) += s.weight.at<float>(here);
        });
        return d;
    }
    cv::Mat times(const cv::Mat& x) const {
        cv::Mat result = kScreening * x;
        each([&](const Steps& s, const cv::Point& here, const cv::Point& there) {
            const float flow = s.weight.at<float>(here) * (x.at<float>(there) - x.at<float>(here));
            result.at<float>(there) += flow;
            result.at<float>(here) -= flow;
        });
        return result;
    }

    const Steps &right_, &down_;
};

}  // namespace

cv::Mat stain_evidence(const AreaFeatures& features) {
    const Steps right = steps_to(features, {1, 0}), down = steps_to(features, {0, 1});
    return Summation(right, down).solve();
}

}  // namespace tangi
