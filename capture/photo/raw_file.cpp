#include "capture/photo/raw_file.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "capture/photo/rejected_photo.h"
#include "surface/base/error.h"
#include "surface/image/memory_budget.h"
#include "surface/image_file/image_io.h"
#include "surface/image_file/picture_header.h"
#include "surface/image_file/safe_picture.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

using OIIO::TypeDesc;

constexpr const char* kRemedy =
    "convert it to DNG (uncompressed, with a DNG converter) or to a linear 16-bit TIFF with the camera "
    "maker's "
    "program";

// What must be so for numbers to be proportional to light.
OIIO::ImageSpec neutral_settings() {
    OIIO::ImageSpec config;
    config.attribute("raw:ColorSpace", "raw");
    config.attribute("raw:auto_bright", 0);
    config.attribute("raw:use_camera_wb", 0);
    config.attribute("raw:use_camera_matrix", 1);
    config.attribute("raw:adjust_maximum_thr", 0.0f);
    config.attribute("raw:balance_clamped", 0);
    // Rows as the sensor has them: all photographs of a stack alike, and lights in the frame of the camera.
    config.attribute("raw:user_flip", 0);
    // "Unclip": channels are scaled down to balance them, never up, so that none loses its brightest values.
    config.attribute("raw:HighlightMode", 1);
    return config;
}

// LibRaw asks for memory by what the header claims before it looks for the pixels.
void require_possible_raw(const fs::path& path) {
    const FileBytes file(path);
    const auto claims = raw_header(file);
    if (claims && claims->least_file > static_cast<double>(file.size()))
        fail_photo(path,
                   "is damaged: it says that it has {} x {} pixels, which its {} bytes cannot hold; copy it "
                   "again from where it came",
                   claims->width, claims->height, file.size());
}

// [bytes a pixel] That LibRaw takes to fill in colours, as measured (raw_file.h).
double developing_bytes(const std::string& demosaic) {
    return demosaic == "AAHD" ? 60 : demosaic == "DCB" ? 45 : 30;
}

std::unique_ptr<OIIO::ImageInput> opened(const fs::path& path, const OIIO::ImageSpec& config) {
    OIIO::attribute("debug", 0);  // else it tells stderr that settings which we want have no effect
    auto input = OIIO::ImageInput::create("raw");
    if (!input)
        fail("{}: camera raw cannot be read, since OpenImageIO was built without LibRaw; {}", path.string(),
             kRemedy);
    OIIO::ImageSpec spec;
    if (!input->open(path.string(), spec, config))
        fail_photo(path, "is not a camera raw that can be read: {}; or {}",
                   trouble_with_picture(path, input->geterror()), kRemedy);
    if (spec.nchannels != 3)
        fail_photo(path, "has {} colours, and only cameras with three are supported; {}", spec.nchannels,
                   kRemedy);
    return input;
}

// The first `count` numbers of an attribute; empty where it is not there or holds none that make sense.
std::vector<float> numbers(const OIIO::ImageSpec& spec, const char* name, int count) {
    const OIIO::ParamValue* value = spec.find_attribute(name);
    std::vector<float> result;
    for (int i = 0; value && i < count && static_cast<std::size_t>(i) < value->type().numelements(); ++i) {
        result.push_back(value->get_float_indexed(i));
        if (!std::isfinite(result.back())) return {};
    }
    if (static_cast<int>(result.size()) < count) result.clear();
    return result;
}

RawHeader header_of(const OIIO::ImageSpec& spec) {
    RawHeader header;
    header.width = spec.width;
    header.height = spec.height;
    const std::string make(spec.get_string_attribute("Make")), model(spec.get_string_attribute("Model"));
    header.camera = model.starts_with(make) ? model : make + " " + model;
    for (const char* name : {"raw:cam_mul", "raw:pre_mul"}) {
        const std::vector<float> m = numbers(spec, name, 3);
        if (m.empty() || !(std::min({m[0], m[1], m[2]}) > 0)) continue;
        for (std::size_t c = 0; c < 3; ++c) header.white_balance[c] = m[c] / m[1];
        break;
    }
    if (const std::vector<float> m = numbers(spec, "raw:rgb_cam", 12); !m.empty())
        for (std::size_t row = 0; row < 3; ++row)
            for (std::size_t c = 0; c < 3; ++c) header.to_rec709[3 * row + c] = m[4 * row + c];
    return header;
}

}  // namespace

const std::vector<std::string>& demosaic_methods() {
    static const std::vector<std::string> methods = {"AHD", "linear", "VNG", "PPG", "DCB", "DHT", "AAHD"};
    return methods;
}

RawHeader read_raw_header(const fs::path& path) {
    require_possible_raw(path);
    RawHeader header = header_of(opened(path, neutral_settings())->spec());
    // What the camera says about turning is only told where it was not forbidden.
    constexpr int exif_of_flip[] = {1, 1, 1, 3, 1, 8, 6, 1};  // LibRaw: 3 = half a turn, 5 = left, 6 = right
    header.orientation = exif_of_flip[opened(path, {})->spec().get_int_attribute("raw:flip", 0) & 7];
    return header;
}

std::vector<std::uint16_t> develop_raw(const fs::path& path, const std::string& demosaic) {
    const auto& methods = demosaic_methods();
    if (std::find(methods.begin(), methods.end(), demosaic) == methods.end())
        fail("demosaicing by '{}' is not known; there are {}", demosaic, fmt::join(methods, ", "));
    const RawHeader header = read_raw_header(path);
    // Methods compare colours of neighbours, so they need them balanced; what that did is undone below.
    const auto& wb = header.white_balance;
    const float most = std::max({wb[0], wb[1], wb[2]});
    const float multipliers[4] = {wb[0], wb[1], wb[2], wb[1]};
    OIIO::ImageSpec config = neutral_settings();
    config.attribute("raw:user_mul", TypeDesc(TypeDesc::FLOAT, 4), multipliers);
    config.attribute("raw:Demosaic", demosaic);
    require_memory(path, developing_bytes(demosaic) * header.width * header.height,
                   fmt::format("developing its {} x {} pixels", header.width, header.height));
    const auto input = opened(path, config);
    std::vector<std::uint16_t> values(static_cast<std::size_t>(header.width) *
                                      static_cast<std::size_t>(header.height) * 3);
    if (!input->read_image(0, 0, 0, 3, TypeDesc::UINT16, values.data()))
        fail_photo(
            path,
            "cannot be developed: {}; the file is damaged or of a kind that LibRaw does not know; or {}",
            trouble_with_pixels(path, input->geterror()), kRemedy);
    // LibRaw cuts the fractions of the scaled values off: half a step is what that takes on average.
    for (std::size_t i = 0; i < values.size(); ++i) {
        const float back = most / wb[i % 3];
        const float value = back == 1 ? values[i] : (static_cast<float>(values[i]) + 0.5f) * back;
        values[i] = values[i] == 0 ? 0 : static_cast<std::uint16_t>(std::min(value, 65535.0f));
    }
    return values;
}

}  // namespace tangi
