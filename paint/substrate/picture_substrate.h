// picture_substrate.h: a picture as a support to paint on (thesis A.1.2), and supports kept under a name.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "surface/base/options.h"
#include "surface/maps/surface.h"

namespace tangi {

struct PictureSubstrateOptions {
    double pixel_mm = 0.2;
    double relief_mm = 0.2;
    double specular = 0.02, roughness = 0.35;  // of a sized, unvarnished support
    bool pixel_known = true;                   // false: pixel_mm is a guess, and the surface says so

    static constexpr std::string_view name = "picture_substrate";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"pixel_mm", 0.005, 100, "mm", "size of the picture's pixels"}, self.pixel_mm);
        visit(FieldInfo{"relief_mm", 0, 100, "mm", "from the lowest to the highest of a picture's relief"},
              self.relief_mm);
        visit(FieldInfo{"specular", 0, 1, "1", "Ward's rho_s"}, self.specular);
        visit(FieldInfo{"roughness", 0.001, 1, "1", "Ward's alpha"}, self.roughness);
    }
};

// Lightness (L* / 100) of a linear picture: what a relief may be guessed from, bright as high.
Image<float> lightness_of(const Image<Rgb>& linear);

// `linear` as rho_d, clamped to [0, 1]. `relief`, of the same size: its 0.1 % and 99.9 % quantiles are
// relief_mm apart, and its mean is at height 0. Flat where `relief` is empty or all the same. Throws Error
// for fewer than 8 or more than 65536 pixels a side, or a relief of another size or with numbers that are not
// finite.
Surface substrate_of_picture(const Image<Rgb>& linear, const Image<float>& relief,
                             const PictureSubstrateOptions& options);

// Files of supports that were kept under a name, in `folder`: NAME.exr, painting files.
// $XDG_DATA_HOME/tangipaint/substrates, or ~/.local/share/...
std::filesystem::path substrate_shelf();
std::vector<std::string> kept_substrates(const std::filesystem::path& shelf);
// Where a support of this name is kept. Throws Error where the name can be no file's, or is a procedure's
// (substrate.h).
std::filesystem::path kept_substrate(const std::filesystem::path& shelf, const std::string& name);
// Whole or not at all. Throws Error where one of this name is there already.
void keep_substrate(const std::filesystem::path& shelf, const std::string& name, const Surface& surface);

}  // namespace tangi
