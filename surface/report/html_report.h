// html_report.h: what the pages for people have in common. A page is one file, without scripts or network.
#pragma once

#include <filesystem>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "surface/image/image.h"
#include "surface/maps/surface.h"

namespace tangi {

// From the doctype to the headline; "</main></body></html>" ends the page. The title stays text. The page
// says which program it is of.
std::string page_head(const std::string& title);
// Whether a text begins as a page of this title does, of whatever version.
bool begins_as_page(std::string_view text, const std::string& title);

// A light of a hemisphere plot: a dot, a disc of its standard error, and a line from where it was listed. A
// ring instead of the dot where its photograph was held out of the fit.
struct HemisphereLight {
    std::string name;
    std::optional<glm::dvec3> direction;  // [unit vector]; empty: not shown, but counted
    double sigma_deg = 0;
    std::optional<glm::dvec3> listed;  // [unit vector]
    bool held_out = false;
};

// The lights as seen from the camera, numbered from 1: the middle is straight above the painting, the rim its
// plane.
std::string hemisphere(const std::vector<HemisphereLight>& lights);

// "1.234 ± 0.056": as many digits as the error has two of.
std::string with_error(double value, double sigma);
// " ± SIGMA" with so many digits after the point, or more where it would read 0; empty where it is 0: not
// known.
std::string plus_minus(double sigma, int digits);

// A picture, 0..1, as a page takes it: data:image/jpeg. `scratch` is beside which file it may be written for
// a moment.
std::string picture_url(const Image<Rgb>& picture, const std::filesystem::path& scratch);

}  // namespace tangi
