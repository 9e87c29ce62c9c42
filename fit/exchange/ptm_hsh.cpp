#include "fit/exchange/ptm_hsh.h"

#include <Eigen/Core>
#include <Eigen/QR>
#include <cmath>
#include <glm/common.hpp>
#include <numbers>

#include "surface/base/error.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace {

constexpr std::size_t kRtiBandBytes = 96u << 20;

using Matrix = Eigen::MatrixXd;

// Values -> coefficients [term][light], of these lights; throws where they leave a term open.
Matrix inverse_of(RtiBasis basis, std::span<const Vec3> directions, const std::string& what) {
    const int terms = terms_of(basis), lights = static_cast<int>(directions.size());
    if (lights < terms)
        fail("{}: {} photographs are too few for the {} terms of {}; take more, or fewer terms", what, lights,
             terms, name_of(basis));
    Matrix design(lights, terms);
    for (int i = 0; i < lights; ++i) {
        const auto row = rti_terms(basis, directions[static_cast<std::size_t>(i)]);
        for (int t = 0; t < terms; ++t) design(i, t) = row[static_cast<std::size_t>(t)];
    }
    Eigen::ColPivHouseholderQR<Matrix> qr(design);
    qr.setThreshold(1e-4);
    if (qr.rank() < terms)
        fail(
            "{}: its lights determine only {} of the {} terms of {}: they lie in too few elevations or "
            "azimuths; "
            "take fewer terms",
            what, qr.rank(), terms, name_of(basis));
    return qr.solve(Matrix::Identity(lights, lights));
}

// A pixel that not every photograph has: least squares on those that do. False where they are too few.
bool solve_partly(const Matrix& design, std::span<const float> values, std::span<double> coefficients) {
    const auto terms = design.cols();
    Matrix normal = Matrix::Zero(terms, terms);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(terms);
    int count = 0;
    for (Eigen::Index i = 0; i < design.rows(); ++i) {
        const float value = values[static_cast<std::size_t>(i)];
        if (std::isnan(value)) continue;
        normal += design.row(i).transpose() * design.row(i);
        right += value * design.row(i).transpose();
        ++count;
    }
    if (count < terms) return false;
    const Eigen::ColPivHouseholderQR<Matrix> qr(normal);
    if (qr.rank() < terms) return false;
    Eigen::Map<Eigen::VectorXd>(coefficients.data(), terms) = qr.solve(right);
    return true;
}

// Colour and brightness of one pixel: the colour that all photographs have in common, by least squares given
// the brightness; its largest channel becomes 1, and the coefficients take up the rest.
Rgb common_colour(const Matrix& design, std::span<const std::vector<float>> values,
                  std::span<double> brightness) {
    Rgb sum(0);
    double square = 0;
    for (Eigen::Index i = 0; i < design.rows(); ++i) {
        double predicted = 0;
        for (Eigen::Index t = 0; t < design.cols(); ++t)
            predicted += design(i, t) * brightness[static_cast<std::size_t>(t)];
        for (std::size_t c = 0; c < 3; ++c) {
            const float value = values[c][static_cast<std::size_t>(i)];
            if (!std::isnan(value)) sum[static_cast<int>(c)] += static_cast<float>(predicted) * value;
        }
        square += predicted * predicted;
    }
    if (!(square > 0)) return Rgb(1);
    const Rgb colour = glm::max(sum / static_cast<float>(square), Rgb(0));
    const float largest = std::max({colour.r, colour.g, colour.b});
    if (!(largest > 0)) return Rgb(1);
    for (double& coefficient : brightness) coefficient *= largest;
    return colour / largest;
}

Matrix design_of(RtiBasis basis, std::span<const Vec3> directions) {
    Matrix design(static_cast<Eigen::Index>(directions.size()), terms_of(basis));
    for (Eigen::Index i = 0; i < design.rows(); ++i) {
        const auto row = rti_terms(basis, directions[static_cast<std::size_t>(i)]);
        for (Eigen::Index t = 0; t < design.cols(); ++t) design(i, t) = row[static_cast<std::size_t>(t)];
    }
    return design;
}

// Fits pixels from the values of all photographs.
class PixelFitter {
public:
    PixelFitter(RtiBasis basis, std::span<const Vec3> directions, const std::string& what)
        : inverse_(inverse_of(basis, directions, what)), design_(design_of(basis, directions)) {}

    // values[channel][photograph] of one pixel -> the pixel of `image`.
    void fit(std::array<std::vector<float>, 3>& values, RtiImage& image, int x, int y) const {
        const auto terms = static_cast<std::size_t>(design_.cols());
        std::array<double, kMostRtiTerms> found{};
        const std::span<double> coefficients(found.data(), terms);
        float* target = &image.coefficients[pixel_index(image, x, y) * image.stride()];
        std::vector<float> mean;
        if (image.lrgb) {
            mean.resize(values[0].size());
            for (std::size_t i = 0; i < mean.size(); ++i)
                mean[i] = (values[0][i] + values[1][i] + values[2][i]) / 3;
        }
        for (int c = 0; c < image.channels(); ++c) {
            if (!solve(image.lrgb ? mean : values[static_cast<std::size_t>(c)], coefficients)) continue;
            if (image.lrgb) image.colour(x, y) = common_colour(design_, values, coefficients);
            for (std::size_t t = 0; t < terms; ++t)
                target[static_cast<std::size_t>(c) * terms + t] = static_cast<float>(coefficients[t]);
        }
    }

private:
    static std::size_t pixel_index(const RtiImage& image, int x, int y) {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
               static_cast<std::size_t>(x);
    }

    bool solve(const std::vector<float>& values, std::span<double> coefficients) const {
        std::fill(coefficients.begin(), coefficients.end(), 0);
        for (std::size_t i = 0; i < values.size(); ++i) {
            const double value = values[i];
            if (std::isnan(value)) return solve_partly(design_, values, coefficients);
            for (std::size_t t = 0; t < coefficients.size(); ++t)
                coefficients[t] +=
                    inverse_(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(i)) * value;
        }
        return true;
    }

    Matrix inverse_, design_;
};

RtiImage empty_image(RtiBasis basis, bool lrgb, int width, int height) {
    RtiImage image{basis, lrgb, width, height, {}, {}};
    if (lrgb) image.colour = Image<Rgb>(width, height, Rgb(1));
    image.coefficients.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                              image.stride());
    return image;
}

}  // namespace

int terms_of(RtiBasis basis) {
    switch (basis) {
        case RtiBasis::ptm:
            return 6;
        case RtiBasis::hsh4:
            return 4;
        case RtiBasis::hsh9:
            return 9;
        case RtiBasis::hsh16:
            break;
    }
    return 16;
}

std::string_view name_of(RtiBasis basis) {
    switch (basis) {
        case RtiBasis::ptm:
            return "ptm";
        case RtiBasis::hsh4:
            return "hsh4";
        case RtiBasis::hsh9:
            return "hsh9";
        case RtiBasis::hsh16:
            break;
    }
    return "hsh16";
}

std::array<double, kMostRtiTerms> rti_terms(RtiBasis basis, const Vec3& direction) {
    const double u = direction.x, v = direction.y;
    if (basis == RtiBasis::ptm) return {u * u, v * v, u * v, u, v, 1};
    constexpr double pi = std::numbers::pi;
    const double z = std::clamp(static_cast<double>(direction.z), 0.0, 1.0), phi = std::atan2(v, u);
    const double x = 2 * z - 1;                            // the shifted argument of the polynomials
    const double s = std::sqrt(std::max(z - z * z, 0.0));  // half the sine that belongs to it
    std::array<double, kMostRtiTerms> h{};
    h[0] = 1 / std::sqrt(2 * pi);
    h[1] = std::sqrt(6 / pi) * s * std::cos(phi);
    h[2] = std::sqrt(3 / (2 * pi)) * x;
    h[3] = std::sqrt(6 / pi) * s * std::sin(phi);
    if (basis == RtiBasis::hsh4) return h;
    h[4] = -std::sqrt(30 / pi) * s * s * std::cos(2 * phi);
    h[5] = std::sqrt(30 / pi) * s * x * std::cos(phi);
    h[6] = std::sqrt(5 / (2 * pi)) * (1 - 6 * s * s);
    h[7] = std::sqrt(30 / pi) * s * x * std::sin(phi);
    h[8] = -std::sqrt(30 / pi) * s * s * std::sin(2 * phi);
    if (basis == RtiBasis::hsh9) return h;
    h[9] = 2 * std::sqrt(35 / pi) * s * s * s * std::cos(3 * phi);
    h[10] = -std::sqrt(210 / pi) * s * s * x * std::cos(2 * phi);
    h[11] = 2 * std::sqrt(21 / pi) * s * (1 - 5 * s * s) * std::cos(phi);
    h[12] = std::sqrt(7 / (2 * pi)) * x * (1 - 10 * s * s);
    h[13] = 2 * std::sqrt(21 / pi) * s * (1 - 5 * s * s) * std::sin(phi);
    h[14] = -std::sqrt(210 / pi) * s * s * x * std::sin(2 * phi);
    h[15] = 2 * std::sqrt(35 / pi) * s * s * s * std::sin(3 * phi);
    return h;
}

RtiImage fit_rti(const Stack& stack, RtiBasis basis, bool lrgb, const Progress& progress,
                 bool stored_linear) {
    std::vector<Vec3> directions;
    for (const StackPhoto& photo : stack.photos) directions.push_back(photo.light.direction);
    const PixelFitter fitter(basis, directions, stack.folder.string());
    RtiImage image = empty_image(basis, lrgb, stack.width(), stack.height());
    const Transfer srgb{Transfer::Kind::srgb};
    const bool is_linear = stored_linear || stack.development;
    StackReader reader(stack);
    const int rows = reader.rows_for(kRtiBandBytes);
    for (int y0 = 0; y0 < stack.height(); y0 += rows) {
        const Band band = reader.read(y0, std::min(y0 + rows, stack.height()), Transfer{});
        parallel_for(band.y0(), band.y1(), 1, [&](int begin, int end) {
            std::array<std::vector<float>, 3> values;
            for (std::vector<float>& channel : values) channel.resize(directions.size());
            for (int y = begin; y < end; ++y)
                for (int x = 0; x < stack.width(); ++x) {
                    for (std::size_t c = 0; c < 3; ++c)
                        for (std::size_t i = 0; i < directions.size(); ++i) {
                            const float value = band.row(
                                static_cast<int>(i), std::min(static_cast<int>(c), stack.channels - 1), y)[x];
                            values[c][i] = is_linear && !std::isnan(value) ? srgb.encode(value) : value;
                        }
                    fitter.fit(values, image, x, y);
                }
        });
        report(progress, name_of(basis), band.y1() / static_cast<double>(stack.height()));
    }
    return image;
}

std::vector<Vec3> hemisphere_directions(int count, double lowest_deg) {
    std::vector<Vec3> directions;
    const double lowest = std::sin(lowest_deg * std::numbers::pi / 180);
    for (int i = 0; i < count; ++i) {
        const double z = 1 - (1 - lowest) * (i + 0.5) / count, across = std::sqrt(1 - z * z);
        const double turn = i * std::numbers::pi * (3 - std::sqrt(5.0));
        directions.push_back(Vec3(glm::dvec3(across * std::cos(turn), across * std::sin(turn), z)));
    }
    return directions;
}

RtiImage rti_of(const Surface& surface, RtiBasis basis, bool lrgb, const Transfer& transfer,
                const RtiSampling& sampling, const Progress& progress) {
    const std::vector<Vec3> directions = hemisphere_directions(sampling.directions, sampling.lowest_deg);
    const Matrix inverse = inverse_of(basis, directions, "export");
    RtiImage image = empty_image(basis, lrgb, surface.width(), surface.height());
    const int terms = terms_of(basis);
    const float white = static_cast<float>(surface.photography.white_level);
    Image<Rgb> sum(lrgb ? surface.width() : 0, lrgb ? surface.height() : 0);
    for (std::size_t i = 0; i < directions.size(); ++i) {
        Image<Rgb> picture = relight(surface, std::vector{distant_light(directions[i])}, sampling.relight);
        parallel_for(0, surface.height(), 16, [&](int begin, int end) {
            for (int y = begin; y < end; ++y)
                for (int x = 0; x < surface.width(); ++x) {
                    // As a viewer shows it: what is brighter than white is white.
                    const Rgb value = glm::min(transfer.encode(white * picture(x, y)), Rgb(1));
                    float* target = &image.coefficients[(static_cast<std::size_t>(y) *
                                                             static_cast<std::size_t>(image.width) +
                                                         static_cast<std::size_t>(x)) *
                                                        image.stride()];
                    if (lrgb) sum(x, y) += value;
                    for (int c = 0; c < image.channels(); ++c)
                        for (int t = 0; t < terms; ++t)
                            target[c * terms + t] +=
                                static_cast<float>(inverse(t, static_cast<Eigen::Index>(i))) *
                                (lrgb ? (value.r + value.g + value.b) / 3 : value[c]);
                }
        });
        report(progress, name_of(basis), static_cast<double>(i + 1) / static_cast<double>(directions.size()));
    }
    for (std::size_t i = 0; i < sum.size(); ++i) {
        const Rgb& total = sum.pixels()[i];
        const float largest = std::max({total.r, total.g, total.b});
        if (!(largest > 0)) continue;
        image.colour.pixels()[i] = total / largest;
        const float scale = 3 * largest / (total.r + total.g + total.b);
        for (std::size_t t = 0; t < image.stride(); ++t) image.coefficients[i * image.stride() + t] *= scale;
    }
    return image;
}

Image<Rgb> evaluate(const RtiImage& image, const Vec3& direction) {
    const auto functions = rti_terms(image.basis, direction);
    const int terms = terms_of(image.basis);
    Image<Rgb> picture(image.width, image.height);
    parallel_for(0, image.height, 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < image.width; ++x) {
                const float* a =
                    &image.coefficients[(static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                                         static_cast<std::size_t>(x)) *
                                        image.stride()];
                Rgb value(0);
                for (int c = 0; c < image.channels(); ++c) {
                    double sum = 0;
                    for (int t = 0; t < terms; ++t)
                        sum += static_cast<double>(a[c * terms + t]) * functions[static_cast<std::size_t>(t)];
                    value[c] = static_cast<float>(sum);
                }
                picture(x, y) = image.lrgb ? value.r * image.colour(x, y) : value;
            }
    });
    return picture;
}

}  // namespace tangi
