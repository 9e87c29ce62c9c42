#include "fit/light_checks/turned_photos.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "capture/stack/duplicate_photos.h"
#include "capture/stack/stack_calibration.h"
#include "surface/base/log_ratio.h"
#include "surface/base/parallel.h"
#include "surface/base/symmetric_matrix.h"

namespace tangi {

namespace {

constexpr std::size_t kFewestPosed = 8;
constexpr int kPoseRounds = 6;         // of poses that predict each other
constexpr float kPoseFloor = 0.02f;    // [1] of full scale (kBlackLevel of the survey): darker is shadow
constexpr double kMostlyPaired = 0.9;  // [1] samples that lie on others in every pose
constexpr int kPoseParts = 8;          // of the picture, along each side
// [1] Most of what changes: of lights in a wrong order it is little, and what they predict means nothing.
constexpr double kMostExplained = 0.5;
constexpr double kSureOfPose = 6;        // [standard errors] as of axis_check_slopes.h
constexpr std::size_t kAllButThird = 3;  // as require_few(): what so many lack is looked at first
constexpr double kClearlyPosed = -0.5;   // ln of a ratio of squares, likewise

std::vector<PhotoPose> poses_of(int width, int height) {
    std::vector<PhotoPose> poses;
    for (const bool mirrored : {false, true})
        for (int quarters = 0; quarters < 4; ++quarters)
            if (quarters % 2 == 0 || width == height) poses.push_back({mirrored, quarters});
    return poses;
}

// Twice the place from the middle, so that it is whole.
glm::ivec2 moved(glm::ivec2 v, const PhotoPose& pose) {
    if (pose.mirrored) v.x = -v.x;
    for (int k = 0; k < pose.quarters; ++k) v = {v.y, -v.x};  // rows run down
    return v;
}

// For each sample, the one that lies there in this pose; -1 where none does.
std::vector<int> pairs_in(const Survey& survey, const PhotoPose& pose, int width, int height) {
    std::map<std::pair<int, int>, int> at;
    const auto centred = [&](const glm::ivec2& p) {
        return glm::ivec2(2 * p.x - (width - 1), 2 * p.y - (height - 1));
    };
    for (int k = 0; k < survey.sample_count(); ++k) {
        const glm::ivec2 p = centred(survey.positions[static_cast<std::size_t>(k)]);
        at.emplace(std::pair(p.x, p.y), k);
    }
    std::vector<int> pairs;
    for (const glm::ivec2& position : survey.positions) {
        const glm::ivec2 p = moved(centred(position), pose);
        const auto found = at.find({p.x, p.y});
        pairs.push_back(found == at.end() ? -1 : found->second);
    }
    return pairs;
}

// The photographs as samples of ln values, each less its mean, in any pose.
class PosedPhotos {
public:
    PosedPhotos(const Survey& survey, const std::vector<Light>& lights, int width, int height)
        : survey_(survey), poses_(poses_of(width, height)), width_(width), height_(height) {
        for (const PhotoPose& pose : poses_) pairs_.push_back(pairs_in(survey, pose, width, height));
        read_values();
        Eigen::MatrixXd terms(count(), 3);
        for (Eigen::Index i = 0; i < count(); ++i) {
            const Vec3& d = lights[static_cast<std::size_t>(i)].direction;
            terms.row(i) << 1, static_cast<double>(d.x), static_cast<double>(d.y);
        }
        // Lights in one plane leave a direction open, of which nothing is predicted.
        const Eigen::MatrixXd spanned = orthonormal_span(terms);
        hat_ = (spanned * spanned.transpose()).cast<float>();
    }

    Eigen::Index count() const { return values_.cols(); }
    std::size_t poses() const { return poses_.size(); }
    const PhotoPose& pose(std::size_t k) const { return poses_[k]; }
    bool is_whole() const {
        for (const std::vector<int>& pairs : pairs_) {
            const auto paired =
                static_cast<double>(std::count_if(pairs.begin(), pairs.end(), [](int k) { return k >= 0; }));
            if (!(paired > kMostlyPaired * static_cast<double>(pairs.size()))) return false;
        }
        return count() > 0 && values_.rows() > 0;
    }

    Eigen::VectorXf in_pose(Eigen::Index photo, std::size_t pose) const {
        Eigen::VectorXf result(values_.rows());
        for (Eigen::Index k = 0; k < result.size(); ++k) {
            const int from = pairs_[pose][static_cast<std::size_t>(k)];
            result[k] = from < 0 ? 0 : values_(from, photo);
        }
        return result;
    }
    Eigen::MatrixXf in_poses(const std::vector<std::size_t>& poses) const {
        Eigen::MatrixXf result(values_.rows(), count());
        for (Eigen::Index i = 0; i < count(); ++i)
            result.col(i) = in_pose(i, poses[static_cast<std::size_t>(i)]);
        return result;
    }
    // What the other photographs make of this one.
    Eigen::VectorXf predicted(const Eigen::MatrixXf& posed, Eigen::Index photo) const {
        Eigen::VectorXf weights = hat_.row(photo).transpose();
        const float own = weights[photo];
        weights[photo] = 0;
        return posed * (weights / std::max(1 - own, 0.1f));
    }
    // [0..1] What the lights explain of what changes from photograph to photograph.
    double explained(const Eigen::MatrixXf& posed) const {
        const Eigen::MatrixXf changes = posed.colwise() - posed.rowwise().mean();
        const Eigen::MatrixXf left = posed - posed * hat_;
        const auto all = static_cast<double>(changes.squaredNorm());
        return all > 0 ? 1 - static_cast<double>(left.squaredNorm()) / all : 0;
    }
    int part_of(Eigen::Index sample) const {
        const glm::ivec2 at = survey_.positions[static_cast<std::size_t>(sample)];
        return at.y * kPoseParts / height_ * kPoseParts + at.x * kPoseParts / width_;
    }

private:
    void read_values() {
        const auto photos = static_cast<Eigen::Index>(survey_.photos.size());
        values_.resize(survey_.sample_count(), photos);
        for (Eigen::Index k = 0; k < values_.rows(); ++k) {
            const float* value = survey_.sample(static_cast<int>(k));
            for (Eigen::Index i = 0; i < photos; ++i) {
                float sum = 0;
                for (int c = 0; c < survey_.channels; ++c) sum += std::isnan(*value) ? 0 : *value, ++value;
                values_(k, i) = std::log(std::max(sum / static_cast<float>(survey_.channels), kPoseFloor));
            }
        }
        values_.rowwise() -= values_.colwise().mean().eval();
    }

    const Survey& survey_;
    std::vector<PhotoPose> poses_;
    std::vector<std::vector<int>> pairs_;  // [pose][sample]
    int width_, height_;
    Eigen::MatrixXf values_;  // [sample][photo]
    Eigen::MatrixXf hat_;     // [photo][photo] of the least squares that predict photographs
};

// Index of the pose in which a photograph is nearest to what is predicted.
std::size_t nearest_pose(const PosedPhotos& photos, Eigen::Index photo, const Eigen::VectorXf& predicted) {
    std::size_t best = 0;
    float least = 0;
    for (std::size_t k = 0; k < photos.poses(); ++k) {
        const float off = (photos.in_pose(photo, k) - predicted).squaredNorm();
        if (k == 0 || off < least) least = off, best = k;
    }
    return best;
}

// Poses that predict each other, from these on; `misfit`: the mean square that is left.
double settle(const PosedPhotos& photos, std::vector<std::size_t>& poses, bool by_mean) {
    for (int round = 0; round < kPoseRounds; ++round) {
        const Eigen::MatrixXf posed = photos.in_poses(poses);
        const Eigen::VectorXf sum = posed.rowwise().sum();
        const auto others = static_cast<float>(photos.count() - 1);
        std::vector<std::size_t> next = poses;
        parallel_for(0, static_cast<int>(photos.count()), 1, [&](int begin, int end) {
            for (int i = begin; i < end; ++i)
                next[static_cast<std::size_t>(i)] = nearest_pose(
                    photos, i,
                    by_mean ? Eigen::VectorXf((sum - posed.col(i)) / others) : photos.predicted(posed, i));
        });
        if (next == poses) break;
        poses = std::move(next);
    }
    const Eigen::MatrixXf posed = photos.in_poses(poses);
    double misfit = 0;
    for (Eigen::Index i = 0; i < photos.count(); ++i)
        misfit += static_cast<double>((posed.col(i) - photos.predicted(posed, i)).squaredNorm());
    return misfit;
}

// The light that stands highest shows most of what all share.
Eigen::Index highest(const std::vector<Light>& lights) {
    return std::max_element(lights.begin(), lights.end(),
                            [](const Light& a, const Light& b) { return a.direction.z < b.direction.z; }) -
           lights.begin();
}

// As stored, or as laid on the photograph under the highest light: whichever predicts better.
std::vector<std::size_t> best_poses(const PosedPhotos& photos, const std::vector<Light>& lights) {
    std::vector<std::size_t> stored(lights.size(), 0), laid(lights.size(), 0);
    const double as_stored = settle(photos, stored, false);
    const Eigen::VectorXf reference = photos.in_pose(highest(lights), 0);
    for (std::size_t i = 0; i < lights.size(); ++i)
        laid[i] = nearest_pose(photos, static_cast<Eigen::Index>(i), reference);
    settle(photos, laid, true);
    return settle(photos, laid, false) < as_stored ? laid : stored;
}

// Poses against that which most photographs have.
void refer_to_most(const PosedPhotos& photos, std::vector<std::size_t>& poses) {
    std::vector<std::size_t> count(photos.poses(), 0);
    for (const std::size_t pose : poses) ++count[pose];
    const auto most = static_cast<std::size_t>(std::max_element(count.begin(), count.end()) - count.begin());
    if (most == 0) return;
    // Of two places that no pose but one takes into each other.
    const glm::ivec2 probe(2, 1);
    std::size_t back = 0;
    for (std::size_t k = 0; k < photos.poses(); ++k)
        if (moved(moved(probe, photos.pose(most)), photos.pose(k)) == probe) back = k;
    for (std::size_t& pose : poses) {
        const glm::ivec2 to = moved(moved(probe, photos.pose(back)), photos.pose(pose));
        for (std::size_t k = 0; k < photos.poses(); ++k)
            if (moved(probe, photos.pose(k)) == to) {
                pose = k;
                break;
            }
    }
}

// The squares of what a photograph is off a prediction in its pose, over those as it is stored.
LogRatio in_pose_to_stored(const PosedPhotos& photos, const Eigen::MatrixXf& posed, Eigen::Index photo,
                           const Eigen::VectorXf& predicted) {
    const Eigen::VectorXf here = (posed.col(photo) - predicted).cwiseAbs2(),
                          stored = (photos.in_pose(photo, 0) - predicted).cwiseAbs2();
    std::array<std::array<double, 2>, kPoseParts * kPoseParts> parts{};
    for (Eigen::Index k = 0; k < here.size(); ++k) {
        auto& part = parts[static_cast<std::size_t>(photos.part_of(k))];
        part[0] += static_cast<double>(here[k]), part[1] += static_cast<double>(stored[k]);
    }
    LogRatio ratio;
    for (const auto& [in_pose, as_stored] : parts)
        if (as_stored > 0) ratio.add(in_pose, as_stored);
    return ratio;
}

bool is_sure_of_pose(const LogRatio& ratio) {
    return ratio.count() >= kPoseParts && ratio.certainty() > kSureOfPose;
}

}  // namespace

std::string in_words(const PhotoPose& pose) {
    if (!pose.mirrored) return fmt::format("turned by {} degrees", 90 * pose.quarters);
    if (pose.quarters == 0) return "mirrored left to right";
    if (pose.quarters == 2) return "mirrored top to bottom";
    return fmt::format("mirrored and turned by {} degrees", 90 * pose.quarters);
}

std::vector<TurnedPhoto> turned_photos(const Survey& survey, const std::vector<Light>& lights, int width,
                                       int height) {
    if (lights.size() < kFewestPosed) return {};
    const PosedPhotos photos(survey, lights, width, height);
    if (!photos.is_whole()) return {};
    std::vector<std::size_t> poses = best_poses(photos, lights);
    refer_to_most(photos, poses);
    const Eigen::MatrixXf posed = photos.in_poses(poses);
    if (!(photos.explained(posed) > kMostExplained)) return {};
    const Eigen::VectorXf sum = posed.rowwise().sum();
    std::vector<TurnedPhoto> turned;
    for (std::size_t i = 0; i < poses.size(); ++i) {
        if (poses[i] == 0) continue;
        const auto photo = static_cast<Eigen::Index>(i);
        // Shading that is alike in two poses misleads the mean.
        const LogRatio by_light = in_pose_to_stored(photos, posed, photo, photos.predicted(posed, photo)),
                       by_mean = in_pose_to_stored(
                           photos, posed, photo,
                           (sum - posed.col(photo)) / static_cast<float>(photos.count() - 1));
        if (is_sure_of_pose(by_light) && by_light.mean() < kClearlyPosed && is_sure_of_pose(by_mean))
            turned.push_back({i, photos.pose(poses[i]), by_light.mean(), by_light.certainty()});
    }
    return turned;
}

std::string leave_out_turned(Stack& stack, Survey& survey, std::vector<RejectedPhoto>& rejected) {
    const std::size_t all = stack.photos.size();
    const std::vector<TurnedPhoto> turned =
        turned_photos(survey, stack.lights(), stack.width(), stack.height());
    if (turned.empty()) return {};
    std::vector<bool> keep(all, true);
    std::vector<std::string> names;
    for (const TurnedPhoto& photo : turned) {
        const std::string& name = stack.photos[photo.photo].light.name;
        keep[photo.photo] = false;
        names.push_back(name);
        rejected.push_back(
            {name, fmt::format("{}/{}: is {} against most of the others; turn it back, or set its "
                               "EXIF orientation right",
                               stack.folder.string(), name, in_words(photo.pose))});
    }
    const bool alike = std::all_of(turned.begin(), turned.end(),
                                   [&](const TurnedPhoto& t) { return t.pose == turned[0].pose; });
    const std::string what = fmt::format(
        "{}: {} of {} photographs are {} against the others, in their pixels: {}; turn them back, or set "
        "their EXIF orientation right",
        stack.folder.string(), turned.size(), all, alike ? in_words(turned[0].pose) : "turned or mirrored",
        joined(names));
    stack.warnings.push_back(what + "; rejected");
    keep_photos(stack, survey, keep);
    if (kAllButThird * turned.size() < all) return {};
    return what + ". They are so many that the others may be those that are wrong";
}

}  // namespace tangi
