#include "viewer/gpu_relight.h"

#include "viewer/gl/headless.h"
#include "viewer/renderer.h"

namespace tangi {

struct GpuRelight::Impl {
    gl::HeadlessContext context;
    Renderer renderer{SIZE_MAX};  // nobody else waits for the device
    const Surface* surface = nullptr;
};

GpuRelight::GpuRelight(const Surface& surface) : impl_(std::make_unique<Impl>()) {
    impl_->surface = &surface;
    impl_->renderer.set_painting(std::make_shared<TexelTiles>(surface, range_of(surface)),
                                 surface.mm_per_pixel);
}

GpuRelight::~GpuRelight() = default;

Image<Rgb> GpuRelight::relight(const std::vector<Light>& lights, const RelightOptions& options) {
    return relight_with(impl_->renderer, *impl_->surface, lights, options);
}

const std::string& GpuRelight::device() const { return impl_->context.renderer(); }

}  // namespace tangi
