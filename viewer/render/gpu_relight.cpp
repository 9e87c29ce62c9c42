#include "viewer/render/gpu_relight.h"

#include <algorithm>

#include "surface/base/error.h"
#include "viewer/render/headless.h"
#include "viewer/render/renderer.h"

namespace tangi {

namespace {

constexpr int kLargestPiece = 2048;  // [pixels] a side

std::size_t megabytes(int tiles) {
    return static_cast<std::size_t>(tiles) * (kTileTexels * sizeof(Texel)) >> 20;
}

// [pixels] The largest side of a piece whose tiles fit, with those that stand in for them.
int piece_for(const TileCache& cache) {
    if (cache.all() <= cache.layers()) return kLargestPiece;
    int side = kLargestPiece;
    const auto tiles = [&](int texels) { return (texels / kTileSide + 2) * (texels / kTileSide + 2); };
    while (side > kTileSide && tiles(side) + tiles(side / 4) + 1 > cache.layers()) side /= 2;
    return side;
}

}  // namespace

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

Image<Rgb> relight_with(Renderer& renderer, const Surface& surface, const std::vector<Light>& lights,
                        const RelightOptions& options) {
    require_consistent(surface);
    validate(options);
    if (lights.size() > kMostLights)
        fail("{} lights at once are more than the {} that the graphics shader takes", lights.size(),
             kMostLights);
    Scene scene{.lights = lights,
                .reflectance_model = surface.reflectance_model,
                .rig = surface.photography.rig,
                .model = options.model};
    scene.shadows = options.cast_shadows ? Shadows::marched : Shadows::none;
    scene.light_radius_deg = light_radius_deg(surface, options);
    scene.ambient = options.ambient;
    const Shot whole = pixel_by_pixel(surface);
    Image<Rgb> picture(whole.width, whole.height);
    const int side = piece_for(renderer.cache());
    for (int y0 = 0; y0 < whole.height; y0 += side)
        for (int x0 = 0; x0 < whole.width; x0 += side) {
            Shot shot = whole;
            shot.width = std::min(side, whole.width - x0);
            shot.height = std::min(side, whole.height - y0);
            // Rows of the shot run upwards from its lower left corner.
            shot.to_painting[2] =
                whole.to_painting *
                Vec3(static_cast<float>(x0), static_cast<float>(whole.height - y0 - shot.height), 1);
            if (scene.rig.camera_distance_mm)
                shot.eye = {scene.rig.camera_axis_mm, *scene.rig.camera_distance_mm, 1};
            const bool exact = renderer.fetch(scene, shot).exact;
            if (!exact && options.cast_shadows)
                fail(
                    "cast shadows on a painting of {} x {} pixels need {} MB on the graphics device, which "
                    "gives {} MB",
                    whole.width, whole.height, megabytes(renderer.cache().all()),
                    megabytes(renderer.cache().layers()));
            TP_REQUIRE(exact, "pieces are small enough");
            const gl::Target target(shot.width, shot.height, true);
            renderer.draw(scene, shot, target.framebuffer(), true);
            const Image<Rgb> piece = renderer.read(target);
            for (int y = 0; y < shot.height; ++y)
                std::copy(piece.row(y).begin(), piece.row(y).end(), picture.row(y0 + y).begin() + x0);
        }
    return picture;
}

}  // namespace tangi
