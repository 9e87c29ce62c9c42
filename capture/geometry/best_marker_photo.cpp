#include "capture/geometry/best_marker_photo.h"

#include "surface/base/error.h"

namespace tangi {

namespace {

constexpr std::size_t kSoughtFirst = 3;  // photographs, before all are looked through

MarkedPhoto best_of(const PhotoSet& photos, const std::vector<std::size_t>& brightest_first,
                    const Transfer& transfer, const std::optional<std::string>& dictionary,
                    const Progress& progress) {
    MarkedPhoto best;
    std::vector<MarkerSearch> all;
    const std::size_t count = brightest_first.size();
    for (std::size_t i = 0; i < count && (i < kSoughtFirst || best.markers.markers.empty()); ++i) {
        report(progress, "markers", static_cast<double>(i) / static_cast<double>(count));
        all.push_back(find_markers(photos.linear(brightest_first[i], transfer), dictionary));
        MarkerSearch found = photos.size() == 1 ? all.back() : seen_twice(all);
        if (found.markers.size() > best.markers.markers.size()) best = {std::move(found), brightest_first[i]};
    }
    report(progress, "markers", 1);
    return best;
}

}  // namespace

MarkedPhoto find_marked_photo(const PhotoSet& photos, const Transfer& transfer,
                              const std::optional<std::string>& dictionary, const Progress& progress) {
    const std::vector<std::size_t> bright = photos.brightest_first("markers: brightness", progress);
    MarkedPhoto best = best_of(photos, bright, transfer, dictionary, progress);
    if (!best.markers.markers.empty()) return best;
    if (const MarkedPhoto other = dictionary ? best_of(photos, bright, transfer, {}, progress) : best;
        !other.markers.markers.empty()) {
        const Marker& first = other.markers.markers[0];
        fail(
            "{}: there is no marker of dictionary {}, but {} of dictionary {} ({} at ({:.0f}, {:.0f})); ask "
            "for "
            "that one",
            photos.path(other.photo).string(), *dictionary, other.markers.markers.size(),
            other.markers.dictionary, first.id, first.corners_px[0].x, first.corners_px[0].y);
    }
    fail(
        "{}: no ArUco marker is found in {}; leave --marker-mm out, or photograph the markers whole, in "
        "focus "
        "and with a white border",
        photos.folder().string(),
        photos.size() == 1 ? "the photograph" : fmt::format("any two of the {} photographs", photos.size()));
}

}  // namespace tangi
