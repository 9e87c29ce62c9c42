#include "fit/exchange/relight_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"
#include "surface/file/version.h"
#include "surface/image_file/image_io.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

using nlohmann::json;

// The place among ours (u^2, v^2, u v, u, v, 1) of each of their terms of a polynomial.
constexpr std::array<std::size_t, 6> kPtmOrder = {5, 3, 4, 0, 2, 1};

std::size_t our_term(RtiBasis basis, std::size_t theirs) {
    return basis == RtiBasis::ptm ? kPtmOrder[theirs] : theirs;
}

fs::path plane_file(const fs::path& folder, std::size_t plane) {
    return folder / fmt::format("plane_{}.jpg", plane);
}

struct Scale {
    float least, most;
};

Scale scale_of(const RtiImage& image, std::size_t term) {
    const auto terms = static_cast<std::size_t>(terms_of(image.basis));
    Scale scale{0, 0};
    for (std::size_t i = term; i < image.coefficients.size(); i += terms) {
        scale.least = std::min(scale.least, image.coefficients[i]);
        scale.most = std::max(scale.most, image.coefficients[i]);
    }
    if (!(scale.most - scale.least > 1e-6f)) scale.most = scale.least + 1e-6f;
    return scale;
}

template <class T>
T field(const json& info, const char* name, const fs::path& file) {
    try {
        return info.at(name).get<T>();
    } catch (const json::exception&) {
        fail("{}: its field '{}' is missing, or of another kind", file.string(), name);
    }
}

RtiBasis basis_in(const std::string& type, std::size_t terms, const fs::path& file) {
    if (type == "ptm" && terms == 6) return RtiBasis::ptm;
    if (type == "hsh")
        for (const RtiBasis basis : {RtiBasis::hsh4, RtiBasis::hsh9, RtiBasis::hsh16})
            if (static_cast<std::size_t>(terms_of(basis)) == terms) return basis;
    fail(
        "{}: is of type {} with {} terms, and ptm with 6 or hsh with 4, 9 or 16 can be read; export it so, "
        "or fit "
        "the photographs",
        file.string(), shortened(type), terms);
}

}  // namespace

void write_relight_folder(const fs::path& folder, const RtiImage& image, double mm_per_pixel,
                          const Progress& progress) {
    TP_REQUIRE(!image.lrgb, "planes have colours");
    const auto terms = static_cast<std::size_t>(terms_of(image.basis));
    json scales = json::array(), biases = json::array();
    make_folder(folder);
    for (std::size_t term = 0; term < terms; ++term) {
        const std::size_t ours = our_term(image.basis, term);
        const Scale scale = scale_of(image, ours);
        Image<Rgb> plane(image.width, image.height);
        for (std::size_t i = 0; i < plane.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c)
                plane.pixels()[i][static_cast<int>(c)] =
                    (image.coefficients[i * image.stride() + c * terms + ours] - scale.least) /
                    (scale.most - scale.least);
        write_map(plane_file(folder, term), plane);
        for (int c = 0; c < 3; ++c) {
            scales.push_back(scale.most - scale.least);
            biases.push_back(-scale.least / (scale.most - scale.least));
        }
        report(progress, "write planes", static_cast<double>(term + 1) / static_cast<double>(terms));
    }
    const json info = {{"software", program_name()},
                       {"width", image.width},
                       {"height", image.height},
                       {"format", "jpg"},
                       {"type", image.basis == RtiBasis::ptm ? "ptm" : "hsh"},
                       {"colorspace", "rgb"},
                       {"nplanes", 3 * terms},
                       {"quality", 95},
                       {"colorprofile", "sRGB"},
                       {"pixelSizeInMM", mm_per_pixel},
                       {"materials", {{{"scale", scales}, {"bias", biases}}}}};
    write_text_file(folder / "info.json", json_lines(info));
}

bool is_relight_folder(const fs::path& folder) {
    const fs::path file = folder / "info.json";
    if (!fs::is_regular_file(file)) return false;
    const json info = json_or_discarded(read_text_file(file));
    return info.is_object() && info.contains("materials") && info.contains("colorspace");
}

RtiImage read_relight_folder(const fs::path& folder) {
    const fs::path file = folder / "info.json";
    if (!fs::is_regular_file(file)) fail("{}: has no info.json", folder.string());
    const json info = read_json(read_text_file(file), file.string());
    const auto planes = field<std::size_t>(info, "nplanes", file);
    const auto colours = field<std::string>(info, "colorspace", file);
    if ((colours != "rgb" && colours != "lrgb") || planes == 0 || planes > 100 || planes % 3 != 0)
        fail("{}: has {} planes in {}, and rgb and lrgb can be read; export it so", file.string(), planes,
             shortened(colours));
    RtiImage image;
    image.lrgb = colours == "lrgb";
    const std::size_t terms = image.lrgb ? planes - 3 : planes / 3;
    image.basis = basis_in(field<std::string>(info, "type", file), terms, file);
    image.width = field<int>(info, "width", file), image.height = field<int>(info, "height", file);
    const auto material = field<std::vector<json>>(info, "materials", file);
    if (material.empty()) fail("{}: its list 'materials' is empty", file.string());
    const auto scale = field<std::vector<float>>(material[0], "scale", file),
               bias = field<std::vector<float>>(material[0], "bias", file);
    if (scale.size() < planes || bias.size() < planes)
        fail("{}: has {} scales and {} biases for {} planes", file.string(), scale.size(), bias.size(),
             planes);
    for (std::size_t picture = 0; picture < planes / 3; ++picture) {
        const Image<Rgb> plane = read_picture(plane_file(folder, picture));
        if (plane.width() != image.width || plane.height() != image.height)
            fail("{}: is {} x {} pixels, and info.json says {} x {}", plane_file(folder, picture).string(),
                 plane.width(), plane.height(), image.width, image.height);
        if (picture == 0) {
            image.coefficients.resize(plane.size() * image.stride());
            if (image.lrgb) image.colour = Image<Rgb>(image.width, image.height);
        }
        for (std::size_t i = 0; i < plane.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) {
                const std::size_t k = 3 * picture + c;
                const float value = (plane.pixels()[i][static_cast<int>(c)] - bias[k]) * scale[k];
                if (!image.lrgb)
                    image.coefficients[i * image.stride() + c * terms + our_term(image.basis, picture)] =
                        value;
                else if (picture == 0)
                    image.colour.pixels()[i][static_cast<int>(c)] = value;
                else
                    image.coefficients[i * image.stride() + our_term(image.basis, k - 3)] = value;
            }
    }
    return image;
}

}  // namespace tangi
