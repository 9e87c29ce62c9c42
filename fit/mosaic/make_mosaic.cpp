#include "fit/mosaic/make_mosaic.h"

#include <algorithm>
#include <cmath>

#include "fit/mosaic/mosaic_blend.h"
#include "surface/base/error.h"
#include "surface/painting_file/painting_file.h"

namespace tangi {

namespace {

constexpr int kBlock = 1024;  // [pixels] of the wall that are blended at once, a side
constexpr double kScalesDiffer =
    0.01;  // [1] relative, of pixels as registered and as the positions state them
constexpr double kSamePicture = 0.95;  // [1] of a picture that another one shows as well
constexpr double kFarApart_px = 30;    // [pixels] a standard error that says that nothing holds a position

std::string names_of(const std::vector<MosaicPosition>& positions, std::size_t a, std::size_t b) {
    return positions[a].name + " and " + positions[b].name;
}

class MosaicMaker {
public:
    MosaicMaker(const std::vector<MosaicPosition>& positions, const MosaicOptions& options,
                const Progress& progress)
        : positions_(positions), options_(options), progress_(progress) {}

    Mosaic make(const std::optional<LayoutHint>& hint) {
        hinted_ = hint.has_value();
        find_duplicates();
        register_pairs(hint);
        report_.layout = solve_layout(positions_, report_.pairs, 0);
        note_left_out();
        take_scale();
        make_cells();
        report_.scales = solve_scales(report_.layout, maps_);
        const CellGrid grid = grid_of(positions_, report_.layout);
        const MosaicSeams seams = find_seams(grid, report_.layout, maps_, report_.scales);
        blend({positions_, report_.layout, report_.scales, grid, seams});
        integrate();
        measure_seams(grid, seams);
        judge();
        return {std::move(wall_), std::move(errors_), std::move(report_)};
    }

private:
    void find_duplicates() {
        usable_.assign(positions_.size(), true);
        for (std::size_t j = 0; j < positions_.size(); ++j)
            for (std::size_t i = 0; i < j; ++i) {
                if (!usable_[i] || positions_[i].hash != positions_[j].hash) continue;
                usable_[j] = false;
                report_.left_out.push_back({j, fmt::format("it is the same as {}", positions_[i].name)});
                break;
            }
    }

    void register_pairs(const std::optional<LayoutHint>& hint) {
        std::vector<PositionFeatures> features(positions_.size());
        const auto count = static_cast<double>(positions_.size());
        for (std::size_t i = 0; i < positions_.size(); ++i) {
            report(progress_, "features", static_cast<double>(i) / count);
            if (usable_[i]) features[i] = features_of(positions_[i]);
        }
        std::vector<std::pair<std::size_t, std::size_t>> wanted;
        for (std::size_t j = 0; j < positions_.size(); ++j)
            for (std::size_t i = 0; i < j; ++i)
                if (usable_[i] && usable_[j] && (!hint || hint->may_overlap(i, j))) wanted.emplace_back(i, j);
        for (const auto& [i, j] : wanted) {
            report(progress_, "overlaps",
                   static_cast<double>(report_.pairs.size()) / static_cast<double>(wanted.size()));
            report_.pairs.push_back(register_pair(positions_, features, i, j));
        }
    }

    // The pair that comes nearest to joining a position.
    std::string why_left_out(std::size_t position) const {
        const PairRegistration* best = nullptr;
        for (const PairRegistration& pair : report_.pairs)
            if ((pair.first == position || pair.second == position) &&
                (!best || pair.features > best->features))
                best = &pair;
        if (!best) return "the layout puts nothing beside it; look at --layout, or leave it out";
        const std::size_t other = best->first == position ? best->second : best->first;
        if (best->joined())
            return fmt::format(
                "it overlaps {}, but no chain of overlaps leads to {}; add the positions between",
                positions_[other].name, positions_[0].name);
        return fmt::format(
            "it overlaps no other: of {}, {}; photograph it with more overlap, or leave it out",
            positions_[other].name, best->why);
    }

    void note_left_out() {
        std::size_t joined = 0;
        for (std::size_t i = 0; i < positions_.size(); ++i) {
            joined += report_.layout.positions[i].joined;
            if (usable_[i] && !report_.layout.positions[i].joined)
                report_.left_out.push_back({i, why_left_out(i)});
        }
        if (joined >= 2) return;
        if (report_.pairs.empty())
            fail("{}: no two positions are left that could overlap: {}", positions_[0].name,
                 hinted_ ? "by the columns and rows in their names, or in --layout, none are neighbours; say "
                           "with --layout where they are"
                         : "give two that are not the same");
        std::string all;
        for (const LeftOut& out : report_.left_out)
            all += fmt::format("{} {}: {}", all.empty() ? "" : ";", positions_[out.position].name, out.why);
        fail("nothing can be joined to {}:{}", positions_[0].name, all);
    }

    void take_scale() {
        const MosaicLayout& layout = report_.layout;
        report_.mm_per_pixel = positions_[0].mm_per_pixel, report_.scale_known = positions_[0].scale_known;
        for (std::size_t i = 1; i < positions_.size(); ++i) {
            if (!layout.positions[i].joined || !positions_[i].scale_known || !report_.scale_known) continue;
            const double registered = layout.positions[i].pixel * report_.mm_per_pixel;
            if (!(std::abs(registered / positions_[i].mm_per_pixel - 1) > kScalesDiffer)) continue;
            report_.poor.push_back(
                fmt::format("{}: states {:.4g} mm a pixel, but lies on {} as if it were {:.4g}: the scale of "
                            "one of them is "
                            "wrong, and lengths with it; fit it again with --mm-per-pixel",
                            positions_[i].name, positions_[i].mm_per_pixel, positions_[0].name, registered));
        }
    }

    void make_cells() {
        const CellGrid grid = grid_of(positions_, report_.layout);
        report_.cell_px = grid.size;
        for (std::size_t i = 0; i < positions_.size(); ++i)
            maps_.push_back(report_.layout.positions[i].joined
                                ? cells_of(positions_[i], report_.layout.positions[i], grid, progress_)
                                : CellMaps());
    }

    template <class T>
    void put(const Image<T>& part, const Region& at, Image<T>& whole, const T& fill = T()) {
        if (part.empty()) return;
        if (whole.empty()) whole = Image<T>(report_.layout.width, report_.layout.height, fill);
        for (int y = 0; y < part.height(); ++y)
            std::ranges::copy(part.row(y), whole.row(at.y0 + y).begin() + at.x0);
    }

    void take(const Region& at, const MosaicPart& part) {
        const Surface& s = part.surface;
        put(s.normal, at, wall_.normal);
        put(s.diffuse, at, wall_.diffuse);
        put(s.specular, at, wall_.specular);
        put(s.roughness, at, wall_.roughness);
        put(s.confidence, at, wall_.confidence);
        put(s.specular_colour, at, wall_.specular_colour);
        put(s.lobe_axes, at, wall_.lobe_axes);
        put(part.errors.slope, at, errors_.slope);
        put(part.errors.diffuse, at, errors_.diffuse);
        put(part.errors.specular, at, errors_.specular);
        put(part.errors.roughness, at, errors_.roughness);
    }

    void blend(const MosaicBlend& blend) {
        const int width = report_.layout.width, height = report_.layout.height;
        for (int y = 0; y < height; y += kBlock)
            for (int x = 0; x < width; x += kBlock) {
                report(progress_, "blending", y / static_cast<double>(height));
                const Region part{x, y, std::min(x + kBlock, width), std::min(y + kBlock, height)};
                take(part, blended(blend, part));
            }
        wall_.mm_per_pixel = report_.mm_per_pixel, wall_.scale_known = report_.scale_known;
        wall_.reflectance_model = mean_model();
        wall_.photography.white_level = positions_[0].white_level;  // as bright as its photographs
    }

    // Each is one number for a whole painting: of positions by their size.
    ReflectanceModel mean_model() {
        ReflectanceModel model = positions_[0].reflectance_model;
        double roughness = 0, second = 0, pixels = 0;
        for (std::size_t i = 0; i < positions_.size(); ++i) {
            if (!report_.layout.positions[i].joined) continue;
            const double size = static_cast<double>(positions_[i].width) * positions_[i].height;
            roughness += size * positions_[i].reflectance_model.diffuse_roughness;
            second += size * positions_[i].reflectance_model.second_lobe_weight;
            pixels += size;
        }
        model.diffuse_roughness = roughness / pixels, model.second_lobe_weight = second / pixels;
        return model;
    }

    void integrate() {
        HeightTask task;
        if (!errors_.slope.empty()) task.error_mm = &errors_.height;
        report_.height = integrate_normals({wall_.normal, wall_.confidence, wall_.mm_per_pixel},
                                           wall_.height_mm, HeightOptions{}, progress_, task);
        subtract(best_plane(wall_.height_mm, wall_.confidence), wall_.height_mm);
    }

    void measure_seams(const CellGrid& grid, const MosaicSeams& seams) {
        const std::shared_ptr<const Surface> wall(&wall_, [](const Surface*) {});
        const MosaicPosition whole = position_of("seams", wall, nullptr, "");
        PlacedPosition in_place;
        in_place.joined = true;
        const CellMaps cells = cells_of(whole, in_place, grid, progress_);
        Image<float> error(grid.columns, grid.rows), count(grid.columns, grid.rows);
        for (int y = 0; y < errors_.height.height(); ++y)
            for (int x = 0; x < errors_.height.width(); ++x)
                if (const float e = errors_.height(x, y); e > 0) {
                    error(x / grid.size, y / grid.size) += e / static_cast<float>(wall_.mm_per_pixel);
                    ++count(x / grid.size, y / grid.size);
                }
        for (std::size_t i = 0; i < error.size(); ++i) error.pixels()[i] /= std::max(count.pixels()[i], 1.0f);
        report_.seams = seam_steps(maps_, report_.scales, grid, seams.owner, cells, error);
    }

    void judge() {
        for (std::size_t i = 0; i < positions_.size(); ++i)
            if (report_.layout.positions[i].joined)
                for (const std::string& why : positions_[i].poor)
                    report_.poor.push_back(fmt::format("{}: its fit is poor: {}", positions_[i].name, why));
        for (const LeftOut& out : report_.left_out)
            report_.poor.push_back(
                fmt::format("{}: is left out: {}", positions_[out.position].name, out.why));
        for (const PairRegistration& pair : report_.pairs)
            if (pair.joined() && pair.overlap > kSamePicture)
                report_.warnings.push_back(
                    fmt::format("{}: show the same part of the painting; one of them would do",
                                names_of(positions_, pair.first, pair.second)));
        for (const PlacedPair& pair : report_.layout.pairs)
            if (pair.rms_px > options_.max_residual_px)
                report_.poor.push_back(fmt::format(
                    "{}: fit to {:.2g} pixels only, rms of {} patches: the camera's lens may bend lines; fit "
                    "both with --lens",
                    names_of(positions_, pair.first, pair.second), pair.rms_px, pair.ties));
        for (std::size_t i = 0; i < positions_.size(); ++i)
            if (report_.layout.positions[i].sigma_px > kFarApart_px)
                report_.poor.push_back(
                    fmt::format("{}: its place is known to {:.0f} pixels only; photograph it "
                                "with more overlap",
                                positions_[i].name, report_.layout.positions[i].sigma_px));
        for (const SeamSteps& seam : report_.seams) judge(seam);
    }

    void judge(const SeamSteps& seam) {
        const std::string names = names_of(positions_, seam.first, seam.second);
        if (seam.delta_e_2000 > options_.max_delta_e)
            report_.poor.push_back(
                fmt::format("{}: colours differ by {:.2g} (CIEDE2000) across their seam; "
                            "look whether the light changed between them",
                            names, seam.delta_e_2000));
        if (seam.height_error > 0 && seam.height_rms > options_.max_step * seam.height_error)
            report_.poor.push_back(
                fmt::format("{}: heights step by {:.2g} {} across their seam, {:.1f} standard errors; look "
                            "at it in raking "
                            "light",
                            names, seam.height_rms * (report_.scale_known ? 1000 * report_.mm_per_pixel : 1),
                            report_.scale_known ? "µm" : "pixels", seam.height_rms / seam.height_error));
    }

    const std::vector<MosaicPosition>& positions_;
    const MosaicOptions& options_;
    const Progress& progress_;
    bool hinted_ = false;
    std::vector<bool> usable_;
    std::vector<CellMaps> maps_;
    Surface wall_;
    FitErrors errors_;
    MosaicReport report_;
};

}  // namespace

Mosaic make_mosaic(const std::vector<MosaicPosition>& positions, const std::optional<LayoutHint>& hint,
                   const MosaicOptions& options, const Progress& progress) {
    validate(options);
    if (positions.size() < 2) fail("a mosaic has two positions or more; one is given");
    return MosaicMaker(positions, options, progress).make(hint);
}

}  // namespace tangi
