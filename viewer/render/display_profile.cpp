#include "viewer/render/display_profile.h"

#include <fmt/format.h>
#include <lcms2.h>

#include <array>

#include "surface/base/error.h"
#include "surface/file/atomic_file.h"

namespace tangi {

namespace {

struct Closed {
    void operator()(void* profile) const { cmsCloseProfile(profile); }
};
using Profile = std::unique_ptr<void, Closed>;

struct Deleted {
    void operator()(void* transform) const { cmsDeleteTransform(transform); }
};
using Transform = std::unique_ptr<void, Deleted>;

// Rec. 709 (and sRGB) primaries and white, linear.
Profile linear_rec709() {
    const cmsCIExyY white{0.3127, 0.3290, 1};
    const cmsCIExyYTRIPLE primaries{{0.64, 0.33, 1}, {0.30, 0.60, 1}, {0.15, 0.06, 1}};
    cmsToneCurve* straight = cmsBuildGamma(nullptr, 1);
    const std::array<cmsToneCurve*, 3> curves{straight, straight, straight};
    Profile profile(cmsCreateRGBProfile(&white, &primaries, curves.data()));
    cmsFreeToneCurve(straight);
    return profile;
}

}  // namespace

struct Monitor::Impl {
    Profile profile;
    std::string name;
    RenderingIntent intent = RenderingIntent::relative;

    Transform from(const Profile& source, cmsUInt32Number in, cmsUInt32Number out) const {
        const cmsUInt32Number wanted =
            intent == RenderingIntent::relative ? INTENT_RELATIVE_COLORIMETRIC : INTENT_PERCEPTUAL;
        Transform transform(cmsCreateTransform(source.get(), in, profile.get(), out, wanted,
                                               cmsFLAGS_BLACKPOINTCOMPENSATION | cmsFLAGS_NOCACHE));
        TP_REQUIRE(transform, "a profile that was taken transforms");
        return transform;
    }
};

Monitor::Monitor(const std::string& icc, const std::string& source) : impl_(std::make_unique<Impl>()) {
    cmsSetLogErrorHandler(nullptr);
    impl_->profile.reset(cmsOpenProfileFromMem(icc.data(), static_cast<cmsUInt32Number>(icc.size())));
    if (!impl_->profile) fail("{}: is no ICC profile; give the profile of the monitor (.icc, .icm)", source);
    void* profile = impl_->profile.get();
    if (cmsGetColorSpace(profile) != cmsSigRgbData || cmsGetDeviceClass(profile) != cmsSigDisplayClass)
        fail("{}: is an ICC profile, but not one of a monitor in RGB", source);
    const Profile linear = linear_rec709();
    for (const cmsUInt32Number intent : {INTENT_RELATIVE_COLORIMETRIC, INTENT_PERCEPTUAL})
        if (!Transform(cmsCreateTransform(linear.get(), TYPE_RGB_FLT, profile, TYPE_RGB_16, intent, 0)))
            fail("{}: this ICC profile has no colours for the monitor: it is damaged, or lacks tables",
                 source);
    std::array<char, 256> text{};
    cmsGetProfileInfoASCII(profile, cmsInfoDescription, "en", "US", text.data(), text.size());
    impl_->name = text[0] ? text.data() : source;
}

Monitor::~Monitor() = default;
Monitor::Monitor(Monitor&&) noexcept = default;
Monitor& Monitor::operator=(Monitor&&) noexcept = default;

Monitor Monitor::read(const std::filesystem::path& file) { return {read_text_file(file), file.string()}; }

const std::string& Monitor::name() const { return impl_->name; }
RenderingIntent Monitor::intent() const { return impl_->intent; }
void Monitor::set_intent(RenderingIntent intent) { impl_->intent = intent; }

MonitorTable Monitor::table(int side) const {
    TP_REQUIRE(side > 1, "a table has ends");
    const Transform transform = impl_->from(linear_rec709(), TYPE_RGB_FLT, TYPE_RGB_16);
    MonitorTable table{side, {}};
    const auto n = static_cast<std::size_t>(side);
    table.rgb.resize(3 * n * n * n);
    std::vector<float> level(n), row(3 * n);
    for (std::size_t i = 0; i < n; ++i) {
        const float root = static_cast<float>(i) / static_cast<float>(n - 1);
        level[i] = root * root * root;
    }
    for (std::size_t blue = 0; blue < n; ++blue)
        for (std::size_t green = 0; green < n; ++green) {
            for (std::size_t red = 0; red < n; ++red) {
                row[3 * red] = level[red];
                row[3 * red + 1] = level[green];
                row[3 * red + 2] = level[blue];
            }
            cmsDoTransform(transform.get(), row.data(), table.rgb.data() + 3 * n * (green + n * blue),
                           static_cast<cmsUInt32Number>(n));
        }
    return table;
}

void Monitor::apply(std::span<std::uint8_t> rgb) const {
    const Profile srgb(cmsCreate_sRGBProfile());
    const Transform transform = impl_->from(srgb, TYPE_RGB_8, TYPE_RGB_8);
    cmsDoTransform(transform.get(), rgb.data(), rgb.data(), static_cast<cmsUInt32Number>(rgb.size() / 3));
}

}  // namespace tangi
