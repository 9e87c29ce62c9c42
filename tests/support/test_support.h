// test_support.h: what the tests share: folders that vanish, image comparison, the data beside the
// repository.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "surface/base/error.h"
#include "surface/image/image.h"
#include "surface/image_file/image_io.h"
#include "surface/maps/light.h"

#ifdef __SANITIZE_ADDRESS__
// OpenImageIO 2.4 keeps the error message of each reader in a table of the thread, and does not free it.
// Graphics drivers keep what they have compiled.
extern "C" inline __attribute__((used)) const char* __lsan_default_suppressions() {
    return "leak:libOpenImageIO\nleak:libEGL\nleak:libGL\nleak:_dri.so\nleak:libLLVM\nleak:libepoxy\n";
}
#endif

namespace tangi {

// An empty folder that is removed with everything in it.
class TestDir {
public:
    TestDir() {
        std::string pattern = (std::filesystem::temp_directory_path() / "tangi-test-XXXXXX").string();
        path_ = ::mkdtemp(pattern.data());
    }
    ~TestDir() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TestDir(const TestDir&) = delete;
    TestDir& operator=(const TestDir&) = delete;

    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

private:
    std::filesystem::path path_;
};

inline constexpr Transfer kLinear{Transfer::Kind::linear}, kSrgb{Transfer::Kind::srgb};

// The message of the Error that `call` throws; fails the test where it throws none, or something else.
template <class Call>
std::string error_of(Call&& call) {
    try {
        call();
    } catch (const Error& error) {
        return error.what();
    } catch (const std::exception& other) {
        ADD_FAILURE() << "threw another exception than Error: " << other.what();
        return {};
    }
    ADD_FAILURE() << "threw no Error";
    return {};
}

// The names in a folder, sorted: to see that nothing was left behind.
inline std::vector<std::string> names_in(const std::filesystem::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

inline void write_bytes(const std::filesystem::path& path, const std::string& bytes) {
    std::ofstream stream(path, std::ios::binary);
    stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    stream.close();
    if (!stream) throw std::runtime_error("test cannot write " + path.string());
}

inline std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

// No file that is written while it lives can grow beyond `bytes`: a disk that fills up.
class FullDisk {
public:
    explicit FullDisk(std::size_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
        ::getrlimit(RLIMIT_FSIZE, &before_);
        rlimit limit = before_;
        limit.rlim_cur = bytes;
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FullDisk() {
        ::setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }
    FullDisk(const FullDisk&) = delete;
    FullDisk& operator=(const FullDisk&) = delete;

private:
    void (*handler_)(int);
    rlimit before_{};
};

// True where no value of the two images differs by more than `tolerance`; NaN differs from everything.
template <class T>
testing::AssertionResult images_near(const Image<T>& actual, const Image<T>& expected, double tolerance) {
    constexpr std::size_t channels = sizeof(T) / sizeof(float);
    if (actual.region() != expected.region())
        return testing::AssertionFailure() << actual.width() << " x " << actual.height() << " instead of "
                                           << expected.width() << " x " << expected.height();
    std::vector<float> a(actual.size() * channels), b(a.size());
    std::memcpy(a.data(), actual.data(), a.size() * sizeof(float));
    std::memcpy(b.data(), expected.data(), b.size() * sizeof(float));
    for (std::size_t i = 0; i < a.size(); ++i)
        if (!(std::abs(double(a[i]) - double(b[i])) <= tolerance)) {
            const int pixel = static_cast<int>(i / channels);
            return testing::AssertionFailure()
                   << "first at (" << pixel % actual.width() << ", " << pixel / actual.width() << ") channel "
                   << i % channels << ": " << a[i] << " instead of " << b[i] << ", tolerance " << tolerance;
        }
    return testing::AssertionSuccess();
}

// True where two images are the same bit for bit.
template <class T>
bool images_identical(const Image<T>& first, const Image<T>& second) {
    return first.region() == second.region() &&
           (first.empty() || std::memcmp(first.data(), second.data(), first.size() * sizeof(T)) == 0);
}

// The same numbers on every machine and in every run (splitmix64, Steele, Lea, Flood 2014).
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) {}

    double uniform(double low = 0, double high = 1) {
        std::uint64_t z = (state_ += 0x9E3779B97F4A7C15u);
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
        z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
        return low + (high - low) * static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
    }
    float real(double low = 0, double high = 1) { return static_cast<float>(uniform(low, high)); }
    int below(int end) { return static_cast<int>(uniform() * end); }
    double normal() {  // mean 0, standard deviation 1 (Box and Muller 1958)
        return std::sqrt(-2 * std::log(1 - uniform())) * std::cos(2 * std::numbers::pi * uniform());
    }
    Vec3 direction(double smallest_z) {  // unit vector, even over the cap above smallest_z
        const double z = uniform(smallest_z, 1), turn = uniform(0, 2 * std::numbers::pi);
        const double across = std::sqrt(1 - z * z);
        return Vec3(glm::dvec3(across * std::cos(turn), across * std::sin(turn), z));
    }

private:
    std::uint64_t state_;
};

// Distant lights spread over the sky above `lowest_deg` on a spiral, named photo_000.png and so on.
inline std::vector<Light> dome_lights(int count, double lowest_deg = 20) {
    std::vector<Light> lights;
    const double lowest = std::sin(lowest_deg * std::numbers::pi / 180);
    for (int i = 0; i < count; ++i) {
        const double z = lowest + (1 - lowest) * (i + 0.5) / count;
        const double turn = i * std::numbers::pi * (3 - std::sqrt(5.0)), across = std::sqrt(1 - z * z);
        lights.push_back(distant_light(Vec3(glm::dvec3(across * std::cos(turn), across * std::sin(turn), z)),
                                       fmt::format("photo_{:03}.png", i)));
    }
    return lights;
}

// A lights file in which lights have the names they have.
inline void write_lights(const std::filesystem::path& path, const std::vector<Light>& lights) {
    std::string text = fmt::format("{}\n", lights.size());
    for (const Light& l : lights)
        text += fmt::format("{} {} {} {}\n", l.name, l.direction.x, l.direction.y, l.direction.z);
    write_bytes(path, text);
}

// A folder of photographs, 8 bit, and its lights.lp: pixel (x, y) of photograph i is colour (i + x, y, 5 i) /
// 255.
inline void write_test_stack(const TestDir& dir, const std::vector<Light>& lights, int width = 8,
                             int height = 6) {
    for (std::size_t i = 0; i < lights.size(); ++i) {
        Image<Rgb> photo(width, height);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                photo(x, y) = Rgb(static_cast<float>(i) + x, y, 5 * static_cast<float>(i)) / 255.0f;
        write_picture_8bit(dir / lights[i].name, photo);
    }
    write_lights(dir / "lights.lp", lights);
}

// A folder of the data that is too large for the repository: $TANGIPAINT_DATA, or ../shared/data beside the
// source. Tests that need it begin with TP_DATA(path, "real/icon"), are named Data*, and are skipped, saying
// so, without it.
inline std::optional<std::filesystem::path> data_folder(const std::string& name) {
    const char* given = std::getenv("TANGIPAINT_DATA");
    const std::filesystem::path root = given
                                           ? std::filesystem::path(given)
                                           : std::filesystem::path(TP_SOURCE_DIR) / ".." / "shared" / "data";
    if (!std::filesystem::is_directory(root / name)) return std::nullopt;
    return root / name;
}

#define TP_DATA(variable, name)                                                                       \
    const auto variable##_found = ::tangi::data_folder(name);                                         \
    if (!variable##_found) GTEST_SKIP() << "skipped: the data folder '" << (name) << "' is not here"; \
    const std::filesystem::path& variable = *variable##_found

}  // namespace tangi
