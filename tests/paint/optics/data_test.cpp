// data_test.cpp: twelve bands against 38, and predictions against measured paints of other makers.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "paint/optics/kubelka_munk.h"
#include "paint/optics/palette.h"
#include "surface/base/json_reading.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

constexpr std::size_t kSamples = 38;  // 380 to 750 nm by 10

using Table = std::map<std::string, std::vector<double>>;  // by the names in the first line

// Names in quotes may hold commas: not in these tables.
Table table_of(const std::filesystem::path& path) {
    std::ifstream stream(path);
    std::string line, cell;
    std::getline(stream, line);
    std::vector<std::string> names;
    for (std::istringstream cells(line); std::getline(cells, cell, ',');) names.push_back(cell);
    Table table;
    while (std::getline(stream, line)) {
        std::istringstream cells(line);
        for (const std::string& name : names) {
            std::getline(cells, cell, ',');
            table[name].push_back(std::stod(cell));
        }
    }
    return table;
}

// The model of a white LED in docs/theory/kubelka-munk.md.
double warm_led(double nm) {
    const auto bell = [nm](double middle, double below, double above) {
        return std::exp(-0.5 * std::pow((nm - middle) / (nm < middle ? below : above), 2));
    };
    return 0.5626 * bell(452, 9, 13) + bell(587.7, 48, 66);
}

// XYZ of 38 samples under an illuminant of the table: by 5 nm, reflectance interpolated linearly and constant
// outside; Y of white is 1.
struct Observer {
    std::vector<double> weights[3];

    Observer(const std::filesystem::path& tables, const std::string& light) {
        const Table lights = table_of(tables / "illuminants_5nm.csv"),
                    eye = table_of(tables / "cie_1931_2deg_1nm.csv");
        const char* const names[] = {"xbar", "ybar", "zbar"};
        double white = 0;
        for (int c = 0; c < 3; ++c) weights[c].assign(kSamples, 0);
        for (std::size_t i = 0; i < lights.at("wavelength_nm").size(); ++i) {
            const double nm = lights.at("wavelength_nm")[i],
                         power = light == "LED" ? warm_led(nm) : lights.at(light)[i];
            const double position = (std::clamp(nm, 380.0, 750.0) - 380) / 10;
            const auto below = std::min(static_cast<std::size_t>(position), kSamples - 2);
            const double t = position - static_cast<double>(below);
            for (int c = 0; c < 3; ++c) {
                const double w = power * eye.at(names[c])[static_cast<std::size_t>(nm) - 360];
                weights[c][below] += (1 - t) * w;
                weights[c][below + 1] += t * w;
                if (c == 1) white += w;
            }
        }
        for (auto& channel : weights)
            for (double& w : channel) w /= white;
    }
    glm::dvec3 xyz(const std::vector<double>& reflectance) const {
        glm::dvec3 sum(0);
        for (int c = 0; c < 3; ++c)
            for (std::size_t i = 0; i < kSamples; ++i) sum[c] += weights[c][i] * reflectance[i];
        return sum;
    }
};

Lab lab_of(const glm::dvec3& xyz, const glm::dvec3& white) {
    // lab_from_linear() knows XYZ relative to D65's white; so that white goes to white.
    const glm::dmat3 xyz_of_rgb(0.4124564, 0.2126729, 0.0193339, 0.3575761, 0.7151522, 0.1191920, 0.1804375,
                                0.0721750, 0.9503041);
    return lab_from_linear(glm::inverse(xyz_of_rgb) * (xyz / white * glm::dvec3(0.95047, 1, 1.08883)));
}

struct Errors {
    double mean = 0, p95 = 0, most = 0;
};

// 3000 mixtures of one to three of the 19 paints, and white in three of five; parts by volume exponentially
// distributed.
Errors errors_of_twelve_bands(const std::filesystem::path& tables, Illuminant light,
                              const std::string& name) {
    const Table paints = table_of(tables / "artist_paints_k_s.csv");
    const Observer observer(tables, name);
    std::vector<std::string> names;
    for (const auto& [column, unused] : paints)
        if (column.ends_with(".K")) names.push_back(column.substr(0, column.size() - 2));
    const glm::dvec3 white = observer.xyz(std::vector<double>(kSamples, 1));
    Random random(20160501);
    std::vector<double> errors;
    for (int i = 0; i < 3000; ++i) {
        std::map<std::string, double> recipe;
        const int count = 1 + random.below(3);
        while (static_cast<int>(recipe.size()) < count)
            recipe[names[static_cast<std::size_t>(random.below(19))]] = -std::log(1 - random.uniform());
        if (random.uniform() < 0.6) recipe["TitaniumWhite"] = -std::log(1 - random.uniform());
        std::vector<double> reflectance(kSamples);
        for (std::size_t j = 0; j < kSamples; ++j) {
            double k = 0, s = 0;
            for (const auto& [paint, part] : recipe)
                k += part * paints.at(paint + ".K")[j], s += part * paints.at(paint + ".S")[j];
            reflectance[j] = outside_of(opaque_reflectance(k, s), 0.6);
        }
        Spectrum bands;
        for (std::size_t band = 0; band < kBands; ++band)
            bands[band] =
                static_cast<float>(reflectance[static_cast<std::size_t>((kBand_nm[band] - 380) / 10)]);
        errors.push_back(delta_e_2000(lab_of(observer.xyz(reflectance), white), lab_under(bands, light)));
    }
    std::sort(errors.begin(), errors.end());
    Errors result;
    for (const double e : errors) result.mean += e / static_cast<double>(errors.size());
    result.p95 = errors[errors.size() * 95 / 100];
    result.most = errors.back();
    return result;
}

TEST(DataTwelveBands, AreAsGoodAsThirtyEight) {
    TP_DATA(tables, "tables");
    const struct {
        Illuminant light;
        const char* name;
        double mean, most;
    } limits[] = {{Illuminant::d65, "D65", 0.2, 1.3},
                  {Illuminant::d50, "D50", 0.21, 1.5},
                  {Illuminant::a, "A", 0.22, 2.0},
                  {Illuminant::warm_led, "LED", 0.28, 2.0},
                  // Its lines are narrower than the distance of the bands.
                  {Illuminant::f11, "F11", 0.35, 4.0}};
    for (const auto& limit : limits) {
        const Errors errors = errors_of_twelve_bands(tables, limit.light, limit.name);
        fmt::print("12 bands against 38 under {}: dE2000 mean {:.3f}, 95 % {:.2f}, most {:.2f}\n", limit.name,
                   errors.mean, errors.p95, errors.most);
        EXPECT_LE(errors.mean, limit.mean) << limit.name;
        EXPECT_LE(errors.most, limit.most) << limit.name;
        EXPECT_GT(errors.mean, 0.01) << "they can't agree by construction";
    }
}

TEST(DataTwelveBands, ShowPaintsThatTheWeightsWereNotMadeFor) {
    TP_DATA(tables, "tables");
    const Observer observer(tables, "D65");
    const glm::dvec3 white = observer.xyz(std::vector<double>(kSamples, 1));
    std::ifstream stream(tables / "gamblin_conservation_reflectance.csv");
    std::string line;
    std::getline(stream, line);
    double mean = 0, most = 0;
    int count = 0;
    while (std::getline(stream, line)) {
        const auto end_of_name = line.rfind('"');
        ASSERT_NE(end_of_name, std::string::npos) << line;
        std::istringstream cells(line.substr(end_of_name + 2));
        std::vector<double> reflectance;
        for (std::string cell; std::getline(cells, cell, ',');) reflectance.push_back(std::stod(cell));
        while (reflectance.size() < kSamples) reflectance.push_back(reflectance.back());
        Spectrum bands;
        for (std::size_t band = 0; band < kBands; ++band)
            bands[band] =
                static_cast<float>(reflectance[static_cast<std::size_t>((kBand_nm[band] - 380) / 10)]);
        const double error = delta_e_2000(lab_of(observer.xyz(reflectance), white), lab_under(bands));
        mean += error, most = std::max(most, error), ++count;
    }
    ASSERT_EQ(count, 43);
    fmt::print("43 conservation colours by 12 bands: dE2000 mean {:.3f}, most {:.2f}\n", mean / count, most);
    EXPECT_LT(mean / count, 0.15);
    EXPECT_LT(most, 0.8);
}

TEST(DataArtistAcrylics, AreTheTable) {
    TP_DATA(tables, "tables");
    const Table table = table_of(tables / "artist_paints_k_s.csv");
    for (const auto& [column, name] : {std::pair("TitaniumWhite", "Titanium White"),
                                       {"UltramarineBlue", "Ultramarine Blue"},
                                       {"PhthaloGreenBlueShade", "Phthalo Green (Blue Shade)"},
                                       {"BoneBlack", "Bone Black"}}) {
        const Pigment& paint = artist_acrylics().at(name);
        const Pigment& white = artist_acrylics().at("Titanium White");
        for (std::size_t band = 0; band < kBands; ++band) {
            const auto row = static_cast<std::size_t>((kBand_nm[band] - 380) / 10);
            const double k = table.at(std::string(column) + ".K")[row],
                         s = table.at(std::string(column) + ".S")[row];
            EXPECT_NEAR(paint.k[band] / white.s[band] / k, 1, 1e-4) << name << " " << band;
            EXPECT_NEAR(paint.s[band] / white.s[band] / s, 1, 1e-4) << name << " " << band;
        }
    }
}

// A maker's own measurements of 0.15 mm (dry) drawdowns over a white card, specular reflection included:
// paints of the same pigments, of the same kind, from other batches. Hues and depths must be the same.
struct Drawdowns {
    std::vector<std::string> names;
    std::vector<Lab> measured;

    explicit Drawdowns(const std::filesystem::path& tables) {
        const nlohmann::json table = read_json(bytes_of(tables / "golden_hb_9paints_11bands.json"), "JSON");
        const auto nm = table["wavelengths_nm"].get<std::vector<float>>();
        for (const auto& [theirs, ours] : {std::pair("PY83 Diarylide Yellow 1147", "Diarylide Yellow"),
                                           {"PV23 Dioxazine Purple 1150", "Dioxazine Purple"},
                                           {"PB15:3 Phthalo Blue (GS) 1255", "Phthalo Blue (Green Shade)"},
                                           {"PG7 Phthalo Green (BS) 1270", "Phthalo Green (Blue Shade)"},
                                           {"PR254 Pyrrole Red 1277", "Pyrrole Red"},
                                           {"PR122 Quinacridone Magenta 1305", "Quinacridone Magenta"}}) {
            const auto r = table["paints"][theirs]["R"].get<std::vector<float>>();
            Spectrum bands;
            for (std::size_t band = 0; band < kBands; ++band) {
                std::size_t i = 1;
                while (i + 1 < nm.size() && nm[i] < kBand_nm[band]) ++i;
                const float t = (kBand_nm[band] - nm[i - 1]) / (nm[i] - nm[i - 1]);
                bands[band] = (1 - t) * r[i - 1] + t * r[i];
            }
            names.push_back(ours);
            measured.push_back(lab_under(bands));
        }
    }
    Lab predicted(std::size_t i, float thickness_mm, float k2) const {
        const Pigment& paint = artist_acrylics().at(names[i]);
        Spectrum card;
        card.fill(0.8f);
        Spectrum look = film_look({paint.k, paint.s}, thickness_mm, card, k2);
        for (float& r : look) r = 0.04f + 0.96f * r;
        return lab_under(look);
    }
    double mean_error(float thickness_mm, float k2) const {
        double mean = 0;
        for (std::size_t i = 0; i < names.size(); ++i)
            mean +=
                delta_e_2000(predicted(i, thickness_mm, k2), measured[i]) / static_cast<double>(names.size());
        return mean;
    }
};

TEST(DataArtistAcrylics, LookLikeMeasuredDrawdowns) {
    TP_DATA(tables, "tables");
    const Drawdowns cards(tables);
    for (std::size_t i = 0; i < cards.names.size(); ++i) {
        const Lab p = cards.predicted(i, 0.15f, kInternalReflection), m = cards.measured[i];
        const double error = delta_e_2000(p, m);
        fmt::print("{}: predicted {:.1f} {:.1f} {:.1f}, measured {:.1f} {:.1f} {:.1f}, dE2000 {:.1f}\n",
                   cards.names[i], p.l, p.a, p.b, m.l, m.a, m.b, error);
        EXPECT_LT(error, 6) << cards.names[i];
    }
    const double mean = cards.mean_error(0.15f, kInternalReflection);
    fmt::print("mean dE2000 {:.2f}\n", mean);
    EXPECT_LT(mean, 3.5);
}

TEST(DataArtistAcrylics, NeedTheBoundaryAndTheirScale) {
    TP_DATA(tables, "tables");
    const Drawdowns cards(tables);
    const double ours = cards.mean_error(0.15f, kInternalReflection);
    const double bare = cards.mean_error(0.15f, 0), thin = cards.mean_error(0.075f, kInternalReflection);
    fmt::print(
        "mean dE2000 {:.2f}; without the boundary {:.2f}; with half of K and S {:.2f}, with twice {:.2f}\n",
        ours, bare, thin, cards.mean_error(0.3f, kInternalReflection));
    EXPECT_GT(bare, 2 * ours);
    EXPECT_GT(thin, 1.2 * ours);
}

}  // namespace
}  // namespace tangi
