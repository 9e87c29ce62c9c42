#include "capture/stack/duplicate_photos.h"

#include <algorithm>
#include <bit>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>

#include "capture/stack/stack_calibration.h"

namespace tangi {

namespace {

constexpr double kSameLight_deg = 0.5;

// The sampled values of one photograph.
std::vector<float> values_of(const Survey& survey, std::size_t photo) {
    const auto channels = static_cast<std::size_t>(survey.channels);
    std::vector<float> values;
    for (int s = 0; s < survey.sample_count(); ++s) {
        const float* value = survey.sample(s) + photo * channels;
        values.insert(values.end(), value, value + channels);
    }
    return values;
}

// FNV-1a (Fowler, Noll, Vo) over the bits of the values.
std::uint64_t hash_of(const std::vector<float>& values) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (const float value : values) hash = (hash ^ std::bit_cast<std::uint32_t>(value)) * 0x100000001b3u;
    return hash;
}

double degrees_between(const Vec3& a, const Vec3& b) {
    return 2 * std::asin(std::min(1.0, static_cast<double>(glm::length(a - b)) / 2)) * 180 / std::numbers::pi;
}

}  // namespace

void keep_photos(Stack& stack, Survey& survey, const std::vector<bool>& keep) {
    TP_REQUIRE(stack.photos.size() == survey.photos.size() && keep.size() == survey.photos.size(),
               "the survey is of this stack");
    Survey kept = survey;
    kept.photos.clear(), kept.values.clear();
    std::vector<StackPhoto> photos;
    for (std::size_t i = 0; i < keep.size(); ++i)
        if (keep[i]) {
            photos.push_back(stack.photos[i]);
            kept.photos.push_back(survey.photos[i]);
        }
    for (int s = 0; s < survey.sample_count(); ++s)
        for (std::size_t i = 0; i < keep.size(); ++i)
            if (keep[i]) {
                const float* value = survey.sample(s) + i * static_cast<std::size_t>(survey.channels);
                kept.values.insert(kept.values.end(), value, value + survey.channels);
            }
    stack.photos = std::move(photos);
    survey = std::move(kept);
}

std::vector<std::vector<std::size_t>> same_pictures(const Survey& survey) {
    std::map<std::uint64_t, std::vector<std::size_t>> by_hash;
    for (std::size_t i = 0; i < survey.photos.size(); ++i) {
        const std::vector<float> values = values_of(survey, i);
        const auto [low, high] = std::minmax_element(values.begin(), values.end());
        if (!values.empty() && *low < *high) by_hash[hash_of(values)].push_back(i);
    }
    std::vector<std::vector<std::size_t>> groups;
    for (auto& [hash, photos] : by_hash)
        if (photos.size() > 1) groups.push_back(std::move(photos));
    std::sort(groups.begin(), groups.end());
    return groups;
}

void leave_out_copies(Stack& stack, Survey& survey, std::vector<RejectedPhoto>& rejected,
                      std::size_t fewest) {
    const std::vector<std::vector<std::size_t>> groups = same_pictures(survey);
    if (groups.empty()) return;
    const std::size_t all = stack.photos.size();
    if (groups.front().size() == all)
        fail("{}: all {} photographs are the same picture; give photographs under different lights",
             stack.folder.string(), all);
    std::vector<bool> keep(all, true);
    std::vector<RejectedPhoto> lost, copies;  // what a copy shows is there all the same
    for (const std::vector<std::size_t>& group : groups) {
        const Light& first = stack.photos[group.front()].light;
        std::vector<std::string> names;
        double apart_deg = 0;
        for (const std::size_t i : group) {
            names.push_back(stack.photos[i].light.name);
            apart_deg =
                std::max(apart_deg, degrees_between(stack.photos[i].light.direction, first.direction));
        }
        const bool same_light = apart_deg < kSameLight_deg;
        const std::string what =
            same_light ? fmt::format("{}: {} are the same picture; it is used once", stack.folder.string(),
                                     joined(names))
                       : fmt::format(
                             "{}: {} are the same picture, but their lights are {:.0f} degrees apart, and "
                             "nothing tells which is right; put the photographs there that are meant, or "
                             "remove the wrong lines",
                             stack.folder.string(), joined(names), apart_deg);
        for (const std::size_t i : group) {
            if (same_light && i == group.front()) continue;
            keep[i] = false;
            (same_light ? copies : lost).push_back({stack.photos[i].light.name, what});
        }
        stack.warnings.push_back(same_light ? what : what + "; rejected");
    }
    const std::size_t different = all - copies.size();
    if (different < fewest)
        fail("{}: {} of {} photographs are copies of others, which leaves {}; at least {} are needed",
             stack.folder.string(), copies.size(), all, different, fewest);
    require_few(lost, different, fewest, stack.folder.string());
    keep_photos(stack, survey, keep);
    for (const auto& list : {copies, lost}) rejected.insert(rejected.end(), list.begin(), list.end());
}

}  // namespace tangi
