// photo_source.h: photographs to compare the painting with, as the window wants them.
//
// Who relights and measures is not the viewer's business: cli/ makes a book of capture/ and fit/, which the
// viewer may not use (docs/developer/architecture.md), and hands it to the window.
#pragma once

#include <filesystem>
#include <functional>
#include <glm/gtc/type_precision.hpp>
#include <string>
#include <vector>

#include "surface/base/progress.h"
#include "surface/maps/light.h"

namespace tangi {

// How alike a photograph and the painting relit at its light are, over some pixels; as compare() measures it.
struct Likeness {
    std::size_t pixels = 0;  // that were compared; without any, the rest means nothing
    double psnr_db = 0, ssim = 0, delta_e_2000 = 0, delta_e_2000_p95 = 0;
};

// A photograph beside the painting relit at its light; all pictures 8-bit sRGB, of one size.
struct HeldPhoto {
    using Picture = Image<glm::u8vec3>;

    int index = 0;  // in the book
    Picture photo, relit, difference, delta_e;
    int reduced = 1;  // pixels of the painting for one of the pictures, along each side
    Likeness whole;
    std::size_t bytes = 0;                             // of memory
    std::function<Likeness(const Region&)> measure{};  // in a region of the painting, at full size
};

// Colours of a map of differences, evenly spaced from its lowest value to its highest.
struct ColourScale {
    std::vector<Rgb> colours_srgb;
    double lowest = 0, highest = 1;
};

class PhotoBook {
public:
    struct Entry {
        std::string name;
        Light light;
        bool fitted = false;  // false: the fit never saw it
    };
    virtual ~PhotoBook() = default;

    virtual const std::vector<Entry>& entries() const = 0;
    virtual const std::vector<std::string>& warnings() const = 0;
    virtual const ColourScale& difference_scale()
        const = 0;  // [1] brightness, as stored; > 0: relit is brighter
    virtual const ColourScale& delta_e_scale() const = 0;  // [1] CIEDE2000

    // Reads a photograph, relights the painting, measures. Throws Error where it cannot be read; Cancelled.
    virtual HeldPhoto hold(int index, const Progress& progress) const = 0;

    // What `compare` writes, into a folder: compare.html, compare.json, pictures. The photographs `rejected`,
    // by their indices, are not in it. Throws Error, Cancelled.
    virtual void write_report(const std::filesystem::path& folder, const std::vector<int>& rejected,
                              const Progress& progress) const = 0;
};

}  // namespace tangi
