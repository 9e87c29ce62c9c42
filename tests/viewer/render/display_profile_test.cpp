// display_profile_test.cpp: what is drawn for a monitor's profile is what lcms2 says of the same colours.
#include "viewer/render/display_profile.h"

#include <gmock/gmock.h>
#include <lcms2.h>

#include "tests/support/viewer/viewer_support.h"

namespace tangi {
namespace {

struct Primaries {
    const char* name;
    cmsCIExyYTRIPLE xy;
    double gamma;
};
const Primaries kSrgbLike{"Rec. 709, gamma 2.2", {{0.64, 0.33, 1}, {0.30, 0.60, 1}, {0.15, 0.06, 1}}, 2.2};
const Primaries kAdobeRgb{
    "Adobe RGB (1998)", {{0.64, 0.33, 1}, {0.21, 0.71, 1}, {0.15, 0.06, 1}}, 563.0 / 256};
const Primaries kP3{"P3, gamma 2.4", {{0.68, 0.32, 1}, {0.265, 0.69, 1}, {0.15, 0.06, 1}}, 2.4};
const Primaries kLaptop{"45 % NTSC", {{0.59, 0.35, 1}, {0.33, 0.56, 1}, {0.155, 0.12, 1}}, 2.2};

std::string bytes_of_profile(cmsHPROFILE profile) {
    cmsUInt32Number size = 0;
    cmsSaveProfileToMem(profile, nullptr, &size);
    std::string icc(size, '\0');
    cmsSaveProfileToMem(profile, icc.data(), &size);
    cmsCloseProfile(profile);
    return icc;
}

std::string profile_of(const Primaries& p) {
    const cmsCIExyY white{0.3127, 0.3290, 1};
    cmsToneCurve* curve = cmsBuildGamma(nullptr, p.gamma);
    cmsToneCurve* curves[] = {curve, curve, curve};
    cmsHPROFILE profile = cmsCreateRGBProfile(&white, &p.xy, curves);
    cmsFreeToneCurve(curve);
    return bytes_of_profile(profile);
}

using Bytes = std::vector<std::uint8_t>;

// Colours of the whole cube, [sRGB 0..255], and near its walls.
Bytes many_colours() {
    Random random(7);
    Bytes colours;
    for (int i = 0; i < 128 * 96 * 3; ++i) {
        const double v = random.real(-40, 295);
        colours.push_back(static_cast<std::uint8_t>(std::lround(std::clamp(v, 0.0, 255.0))));
    }
    return colours;
}

// lcms2's own 16-bit transform from sRGB, as 8-bit numbers in 1/257.
std::vector<double> by_lcms(const std::string& icc, const Bytes& colours) {
    cmsHPROFILE srgb = cmsCreate_sRGBProfile();
    cmsHPROFILE monitor = cmsOpenProfileFromMem(icc.data(), static_cast<cmsUInt32Number>(icc.size()));
    cmsHTRANSFORM transform =
        cmsCreateTransform(srgb, TYPE_RGB_FLT, monitor, TYPE_RGB_FLT, INTENT_RELATIVE_COLORIMETRIC,
                           cmsFLAGS_BLACKPOINTCOMPENSATION);
    std::vector<float> in(colours.begin(), colours.end()), out(in.size());
    for (float& v : in) v /= 255;
    cmsDoTransform(transform, in.data(), out.data(), static_cast<cmsUInt32Number>(in.size() / 3));
    cmsDeleteTransform(transform);
    cmsCloseProfile(monitor);
    cmsCloseProfile(srgb);
    std::vector<double> values;
    for (const float v : out) values.push_back(255 * std::clamp(v, 0.0f, 1.0f));
    return values;
}

double part_near(const std::vector<double>& a, const std::vector<double>& b, double by) {
    double near = 0;
    for (std::size_t i = 0; i < a.size(); ++i) near += std::abs(a[i] - b[i]) <= by;
    return near / static_cast<double>(a.size());
}

class MonitorTest : public Drawing {
protected:
    // The colours as matt paint, looked at as they are, drawn by OpenGL for the monitor [0..255].
    std::vector<double> drawn_for(const std::optional<MonitorTable>& table, const Bytes& colours) {
        Surface s(128, 96);
        const Transfer srgb{Transfer::Kind::srgb};
        std::size_t at = 0;
        for (Rgb& c : s.diffuse.pixels())
            for (int i = 0; i < 3; ++i) c[i] = srgb.decode(static_cast<float>(colours[at++]) / 255);
        show(s);
        if (table) renderer_->set_monitor(*table);
        Scene scene{.mode = ViewMode::diffuse};
        scene.on_monitor = true;
        std::vector<double> values;
        const Image<Rgb> picture = drawn(scene, pixel_by_pixel(s), false);
        for (const Rgb& c : picture.pixels())
            for (int i = 0; i < 3; ++i) values.push_back(255.0 * c[i]);
        return values;
    }
};

// The texels hold 8 bits of colour: what is drawn as sRGB is the truth that the profile is applied to.
TEST_F(MonitorTest, DrawsWhatLcmsComputes) {
    const Bytes colours = many_colours();
    const std::vector<double> plain = drawn_for({}, colours);
    Bytes seen;
    for (const double v : plain) seen.push_back(static_cast<std::uint8_t>(std::lround(v)));
    for (const Primaries& primaries : {kSrgbLike, kAdobeRgb, kP3, kLaptop}) {
        const std::string icc = profile_of(primaries);
        const std::vector<double> drawn = drawn_for(Monitor(icc, "test").table(), colours);
        const std::vector<double> truth = by_lcms(icc, seen);
        // A panel that has not all of the colours clips them: that bends more sharply than a table can.
        const bool clips = std::string(primaries.name) == kLaptop.name;
        EXPECT_GE(part_near(drawn, truth, 1), clips ? 0.98 : 0.9999) << primaries.name;
        EXPECT_LT(part_near(plain, truth, 1), 0.8) << primaries.name << ": it matters";
    }
}

TEST(Monitor, ChangesBytesAsLcmsDoes) {
    Bytes colours = many_colours();
    const std::string icc = profile_of(kAdobeRgb);
    const std::vector<double> truth = by_lcms(icc, colours);
    Monitor(icc, "test").apply(colours);
    EXPECT_GE(part_near(std::vector<double>(colours.begin(), colours.end()), truth, 1.01), 0.999);
}

// Neutral and of the display's own white: with a black point of 2 % in the monitor, black is black and not
// lighter.
TEST(Monitor, WhiteAndBlackAreTheMonitorsOwn) {
    for (const Primaries& primaries : {kSrgbLike, kAdobeRgb, kP3, kLaptop})
        for (const RenderingIntent intent : {RenderingIntent::relative, RenderingIntent::perceptual}) {
            Monitor monitor(profile_of(primaries), "test");
            monitor.set_intent(intent);
            const MonitorTable table = monitor.table(9);
            ASSERT_EQ(table.rgb.size(), 3u * 9 * 9 * 9);
            for (std::size_t i = 0; i < 3; ++i) {
                EXPECT_EQ(table.rgb[i], 0);
                EXPECT_NEAR(table.rgb[table.rgb.size() - 1 - i], 65535, 40) << primaries.name;
            }
        }
}

TEST(Monitor, SaysWhatIsNoProfileOfAMonitor) {
    const auto complaint = [](const std::string& icc) {
        try {
            const Monitor monitor(icc, "m.icc");
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string("taken");
    };
    EXPECT_THAT(complaint("no profile"), testing::HasSubstr("m.icc: is no ICC profile"));
    EXPECT_THAT(complaint(bytes_of_profile(cmsCreateLab4Profile(nullptr))),
                testing::HasSubstr("not one of a monitor"));
    const std::string whole = profile_of(kP3);
    EXPECT_EQ(complaint(whole), "taken");
    for (std::size_t size : {whole.size() / 3, whole.size() / 2})
        EXPECT_THAT(complaint(whole.substr(0, size)), testing::HasSubstr("m.icc: ")) << size;
    EXPECT_THROW(Monitor::read("/nowhere/m.icc"), Error);
}

}  // namespace
}  // namespace tangi
