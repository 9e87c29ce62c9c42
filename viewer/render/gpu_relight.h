// gpu_relight.h: relight() drawn by OpenGL without a window: on a graphics card in no time, the same picture
// to 1/255 of white on 99.9 % of the pixels.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "surface/render/relight.h"

namespace tangi {

class GpuRelight {
public:
    // Uploads the surface, which must outlive this. Throws Error where there is no OpenGL here, or the
    // surface is too large for it.
    explicit GpuRelight(const Surface& surface);
    ~GpuRelight();
    GpuRelight(const GpuRelight&) = delete;
    GpuRelight& operator=(const GpuRelight&) = delete;

    // As relight() in surface/render/relight.h. Throws Error for more than 8 lights.
    Image<Rgb> relight(const std::vector<Light>& lights, const RelightOptions& options);
    const std::string& device() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace tangi
