// stroke.h: from timed points of a pen or mouse to steps of a brush on the canvas.
//
// The path is a centripetal Catmull-Rom spline (Yuksel, Schaefer, Keyser 2011, "Parameterization and
// applications of Catmull-Rom curves": it has neither cusps nor loops within a segment), resampled by arc
// length. Points are taken one by one, so that painting live and replaying give the same bits.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "paint/brush/brush.h"
#include "paint/canvas/canvas.h"
#include "paint/stroke/brush_steps.h"
#include "paint/stroke/upper_film.h"

namespace tangi {

// One sample of the pen, in the surface frame: mm from the centre of the picture, x right, y up.
struct StrokePoint {
    double time_s = 0;  // since the start of the stroke; never decreasing
    double x_mm = 0, y_mm = 0;
    double pressure = 0.5;          // [1] 0..1
    double tilt_x = 0, tilt_y = 0;  // [1] sine of the handle's tilt towards x and y; length <= 1
    double rotation_deg = 0;        // of the brush's width against the x axis, counter-clockwise
};

// Points nearer to the end of a slack string do not move the brush: smooths a shaky hand.
struct StrokeOptions {
    double stabiliser_mm = 0;   // length of the string; 0 = none
    double pressure_gamma = 1;  // pressure is raised to this power
    double spacing_px = 1;      // [pixels] of arc length between steps, to whole parts of a row of pixels

    static constexpr std::string_view name = "stroke";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"stabiliser_mm", 0, 100, "mm", "length of the string that smooths a shaky hand"},
              self.stabiliser_mm);
        visit(FieldInfo{"pressure_gamma", 0.1, 10, "1", "pressure is raised to this power"},
              self.pressure_gamma);
        visit(FieldInfo{"spacing_px", 0.25, 1, "1", "about the arc length between steps, in pixels"},
              self.spacing_px);
    }
};

// The centripetal Catmull-Rom point between b and c at u in 0..1, of any values that can be added and scaled;
// `distance` gives the length between two of them.
struct PathPoint {
    double x = 0, y = 0;
};
PathPoint catmull_rom(const PathPoint& a, const PathPoint& b, const PathPoint& c, const PathPoint& d,
                      double u);

// One stroke: brush and canvas must outlive it.
class Stroke {
public:
    Stroke(Canvas& canvas, Brush& brush, const StrokeOptions& options, std::uint64_t seed);

    // Takes the next point; the canvas changes up to the point before it. Throws Error on values outside
    // their range.
    void add(const StrokePoint& point);
    // Paints what is left. A stroke of a single point is a dab.
    void finish();

    // Calls `look` when the stroke is `first_s` old: between two steps, when all that the brush did until
    // then is on the canvas, and nothing of what comes later. It gives the age at which it is called next,
    // which is more. What is painted does not change by it.
    using Look = std::function<double(double age_s)>;
    void watch(double first_s, Look look);
    double age_s() const { return last_time_s_ - first_time_s_.value_or(last_time_s_); }
    // [1] Of all points so far; what is not pressed paints nothing.
    double greatest_pressure() const { return greatest_pressure_; }
    // The brush was over the canvas at one step at least.
    bool met_canvas() const { return met_canvas_; }

    // Pixels under the brush, summed over all steps: the measure of work.
    double bristle_pixels() const { return bristle_pixels_; }
    int steps() const { return steps_; }

private:
    struct Knot {
        PathPoint at;  // [pixels], y down
        double pressure, tilt_x, tilt_y, rotation_rad;
        double came_s, left_s;  // [s] of the stroke's age, where the brush stands for a while
    };
    Knot knot_of(const StrokePoint& point);
    void segment(const Knot& a, const Knot& b, const Knot& c, const Knot& d);
    void step_to(const Knot& b, const Knot& c, double u, const PathPoint& at, const PathPoint& direction);
    void stand(Dab dab, float side, double age_s);
    void paint();
    void call_look();
    void relax(const Dab& last);
    void come_over(const Dab& dab);
    void come_over(const Region& part, int step);
    // Where the brush went, so many times [1] as steep as paint holds (slump.h). Whether there was any.
    bool slump_walls(float times, int step);
    // Of tiles that no step came over from this one on: paint that the stroke left there
    // (quantise_volumes.h).
    void settle_paint(int before_step);

    Canvas& canvas_;
    Brush& brush_;
    StrokeOptions options_;
    std::uint64_t seed_;
    UpperFilm other_;
    std::vector<Knot> knots_;  // the last four at most
    std::optional<PathPoint> string_end_;
    double spacing_px_ = 1;  // between steps, less where the brush turns
    double way_px_ = 0;
    double left_px_ = 0;                 // of arc length until the next step
    std::optional<float> rotation_rad_;  // at the last step
    std::optional<float> heading_rad_;
    struct UnderWay {
        PaintLayer::TilePtr as_it_was;
        Region part{};  // that steps came over
        int last_step = 0;
    };
    std::map<TileIndex, UnderWay> under_way_;  // what the stroke came over and is not settled
    std::vector<Dab> dabs_;
    std::vector<double> ages_s_;  // of the stroke, at each of them
    std::optional<Dab> last_;
    double look_at_s_ = 0;
    Look look_;
    DabMemory memory_;
    double bristle_pixels_ = 0;
    int steps_ = 0;
    double last_time_s_ = 0, greatest_pressure_ = 0;
    std::optional<double> first_time_s_;
    bool finished_ = false, met_canvas_ = false;
};

}  // namespace tangi
