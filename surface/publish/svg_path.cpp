#include "surface/publish/svg_path.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <span>
#include <utility>

#include "surface/publish/svg_elements.h"

namespace tangi {

namespace {

// Straight lines for a curve: of a quarter of a circle, they are off by 0.0012 of its radius.
constexpr int kLinesOfCurve = 16;

// Numbers that a command takes at a time.
std::size_t numbers_of(char command) {
    switch (command) {
        case 'H':
        case 'V':
            return 1;
        case 'S':
        case 'Q':
            return 4;
        case 'C':
            return 6;
        case 'A':
            return 7;
        default:
            return 2;  // M, L, T
    }
}

class PathReader {
public:
    // One command, with as many numbers as it takes.
    void take(char command, bool relative, std::span<const double> v) {
        const glm::dvec2 origin = relative ? at_ : glm::dvec2(0);
        const auto point = [&](std::size_t i) { return origin + glm::dvec2(v[i], v[i + 1]); };
        const char before = std::exchange(last_, command);
        switch (command) {
            case 'M':
                begin(point(0));
                break;
            case 'H':
                line({origin.x + v[0], at_.y});
                break;
            case 'V':
                line({at_.x, origin.y + v[0]});
                break;
            case 'C':
                cubic(point(0), point(2), point(4));
                break;
            case 'S':
                cubic(before == 'C' || before == 'S' ? mirrored() : at_, point(0), point(2));
                break;
            case 'Q':
                quadratic(point(0), point(2));
                break;
            case 'T':
                quadratic(before == 'Q' || before == 'T' ? mirrored() : at_, point(0));
                break;
            case 'A':
                arc({std::abs(v[0]), std::abs(v[1])}, v[2], v[3] != 0, v[4] != 0, point(5));
                break;
            default:
                line(point(0));
        }
    }
    void close() {
        if (!outlines.empty()) outlines.back().closed = true;
        at_ = start_;
        last_ = 'Z';
    }

    std::vector<SvgOutline> outlines;

private:
    glm::dvec2 mirrored() const { return 2.0 * at_ - control_; }

    void begin(const glm::dvec2& to) {
        outlines.push_back({{to}});
        at_ = start_ = to;
    }
    void line(const glm::dvec2& to) {
        // After Z, or without M at the beginning, an outline begins where the last one did.
        if (outlines.empty() || outlines.back().closed) outlines.push_back({{at_}});
        outlines.back().points.push_back(at_ = to);
    }
    template <class Curve>
    void sample(int lines, const Curve& curve) {
        std::vector<glm::dvec2> points;
        for (int i = 1; i <= lines; ++i) points.push_back(curve(static_cast<double>(i) / lines));
        for (const glm::dvec2& p : points) line(p);
    }
    void cubic(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& to) {
        const glm::dvec2 from = at_;
        sample(kLinesOfCurve, [&](double t) {
            const double u = 1 - t;
            return u * u * u * from + 3 * u * u * t * a + 3 * u * t * t * b + t * t * t * to;
        });
        control_ = b;
    }
    void quadratic(const glm::dvec2& a, const glm::dvec2& to) {
        const glm::dvec2 from = at_;
        sample(kLinesOfCurve, [&](double t) {
            const double u = 1 - t;
            return u * u * from + 2 * u * t * a + t * t * to;
        });
        control_ = a;
    }
    // From its ends to its middle: SVG 1.1, F.6.5; radii that are too small are enlarged, F.6.6.
    void arc(glm::dvec2 radii, double turn_deg, bool large, bool sweep, const glm::dvec2& to) {
        const glm::dvec2 from = at_;
        if (radii.x == 0 || radii.y == 0 || from == to) {
            line(to);
            return;
        }
        const double phi = turn_deg * std::numbers::pi / 180, c = std::cos(phi), s = std::sin(phi);
        const auto turned = [&](const glm::dvec2& p) {
            return glm::dvec2(c * p.x - s * p.y, s * p.x + c * p.y);
        };
        const glm::dvec2 half = 0.5 * (from - to), p(c * half.x + s * half.y, -s * half.x + c * half.y);
        const double needed = glm::dot(p / radii, p / radii);
        radii *= std::sqrt(std::max(needed, 1.0));
        const double part = std::max(0.0, 1 / glm::dot(p / radii, p / radii) - 1);
        const glm::dvec2 centre = (large == sweep ? -1.0 : 1.0) * std::sqrt(part) *
                                  glm::dvec2(radii.x * p.y / radii.y, -radii.y * p.x / radii.x);
        const auto angle = [&](const glm::dvec2& q) {
            const glm::dvec2 unit = (q - centre) / radii;
            return std::atan2(unit.y, unit.x);
        };
        const double first = angle(p), whole = 2 * std::numbers::pi;
        double by = angle(-p) - first;
        if (sweep && by < 0) by += whole;
        if (!sweep && by > 0) by -= whole;
        const glm::dvec2 middle = turned(centre) + 0.5 * (from + to);
        const int quarters = std::max(1, static_cast<int>(std::ceil(4 * std::abs(by) / whole)));
        sample(kLinesOfCurve * quarters, [&](double t) {
            const double a = first + t * by;
            return t == 1 ? to : middle + turned(radii * glm::dvec2(std::cos(a), std::sin(a)));
        });
    }

    glm::dvec2 at_{0}, start_{0}, control_{0};
    char last_ = 0;
};

}  // namespace

std::vector<SvgOutline> outlines_of_path(std::string_view d) {
    constexpr std::string_view kCommands = "MmZzLlHhVvCcSsQqTtAa";
    PathReader reader;
    for (std::size_t at = d.find_first_of(kCommands); at < d.size();) {
        const std::size_t next = std::min(d.find_first_of(kCommands, at + 1), d.size());
        const char letter = d[at];
        const bool relative = std::islower(static_cast<unsigned char>(letter)) != 0;
        char command = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
        const NumberList list = numbers_in_list(d.substr(at + 1, next - at - 1));
        at = next;
        if (command == 'Z') reader.close();
        const std::size_t count = numbers_of(command);
        const std::span<const double> numbers = list.numbers;
        for (std::size_t i = 0; command != 'Z' && i + count <= numbers.size(); i += count) {
            reader.take(command, relative, numbers.subspan(i, count));
            if (command == 'M') command = 'L';  // further ones are lines
        }
        if (!list.rest.empty()) break;
    }
    return std::move(reader.outlines);
}

}  // namespace tangi
