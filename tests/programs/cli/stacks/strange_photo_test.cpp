// strange_photo_test.cpp: photographs of other programs: what is in them is used, or told.
#include <functional>
#include <limits>

#include "tests/programs/support/bad_stack.h"
#include "tests/support/capture/picture_metadata.h"
#include "tests/support/capture/tiff_writer.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(),
                kInfinite = std::numeric_limits<float>::infinity();

void as_exr(GeneratorOptions& o) {
    o.format = GeneratorFormat::exr;
    o.lights = 16;
}

// Puts values into a block of every so many-th photograph.
void spoil(const TinyStack& stack, int step, const std::function<void(Rgb&, int)>& change, int count = 16) {
    for (int i = 0; i < count; i += step) {
        Image<Rgb> photo = read_picture(stack.photo(i));
        for (int y = 10; y < 18; ++y)
            for (int x = 12; x < 20; ++x) change(photo(x, y), x + y);
        write_picture(stack.photo(i), photo, {});
    }
}

double degrees_off(const Surface& a, const Surface& b, const Region& where) {
    double sum = 0;
    for (int y = where.y0; y < where.y1; ++y)
        for (int x = where.x0; x < where.x1; ++x)
            sum += std::acos(
                std::clamp(static_cast<double>(glm::dot(a.normal(x, y), b.normal(x, y))), -1.0, 1.0));
    return sum / (where.width() * where.height()) * 180 / std::numbers::pi;
}

Surface fitted(const TinyStack& stack, const std::string& name, std::vector<std::string> flags = {}) {
    flags.insert(flags.begin(), {"fit", stack.path(), "--out", stack.out(name), "--register", "off"});
    EXPECT_TRUE(ended(tangipaint(flags), 0));
    return read_painting(stack.out(name));
}

TEST(CliStrangePhoto, HasValuesThatAreNoNumbers) {
    const TinyStack stack(as_exr);
    const Surface clean = fitted(stack, "clean.exr");
    const Region block{12, 10, 20, 18};
    const float wrong[] = {kNan, kInfinite, -kInfinite, 1e30f, -9999, 65504};
    spoil(stack, 3, [&](Rgb& pixel, int at) {
        pixel[at % 3] = wrong[static_cast<std::size_t>(at) % std::size(wrong)];
    });
    const auto result =
        expect_warned(stack, {"hold no number", "64 of " + stack.name(0), "count as not photographed"});
    EXPECT_EQ(result["photographs"]["fitted"], 16);
    EXPECT_EQ(result["photographs"]["without_number"].size(), 6u);
    EXPECT_EQ(result["photographs"]["without_number"][0]["pixels"], 64);
    const Surface surface = read_painting(stack.out("a.exr"));  // as others read it
    for (const float c : surface.confidence.pixels()) EXPECT_TRUE(std::isfinite(c));
    // 10 of 16 lights are left there, and they tell the slope as well; taken for black, these six would not.
    const Surface truth = read_painting(stack.truth());
    EXPECT_LT(degrees_off(fitted(stack, "b.exr"), truth, block), degrees_off(clean, truth, block) + 0.5);
    EXPECT_TRUE(ended(tangipaint({"info", stack.out("a.exr")}), 0));
    EXPECT_TRUE(ended(tangipaint({"compare", stack.out("a.exr"), stack.path(), "--out", stack.out("c")}), 0));
}

TEST(CliStrangePhoto, HasNoNumbersInAnyPhotographAtSomePixels) {
    const TinyStack stack(as_exr);
    spoil(stack, 1, [](Rgb& pixel, int at) {
        if (at == 25) pixel.g = kNan;
    });
    const Surface surface = fitted(stack, "a.exr");
    for (int y = 10; y < 18; ++y)
        for (int x = 12; x < 20; ++x) EXPECT_EQ(surface.confidence(x, y) > 0, x + y != 25) << x << ", " << y;
}

// Light in whatever unit gives the same normals.
TEST(CliStrangePhoto, IsOfFloatsInAUnitOfItsOwn) {
    const TinyStack stack(as_exr);
    const Surface clean = fitted(stack, "clean.exr");
    std::vector<Image<Rgb>> photos;
    for (int i = 0; i < 16; ++i) photos.push_back(read_picture(stack.photo(i)));
    for (const float unit : {1e-4f, 3e4f}) {
        for (int i = 0; i < 16; ++i) {
            Image<Rgb> photo = photos[static_cast<std::size_t>(i)];
            for (Rgb& pixel : photo.pixels()) pixel *= unit;
            write_picture(stack.photo(i), photo, {});
        }
        const auto result = expect_warned(stack, {"floats in a unit of their own", "--white-level"});
        EXPECT_TRUE(result["poor"].empty()) << result["poor"];
        EXPECT_GT(result["median_confidence"], 0.9);
        const double white = result["colour"]["white_level"];
        EXPECT_GT(white, 0.4 * static_cast<double>(unit));
        EXPECT_LT(white, 2.5 * static_cast<double>(unit));
        EXPECT_LT(degrees_off(fitted(stack, "b.exr"), clean, {0, 0, 32, 32}), 1) << unit;
        const Finished compared =
            tangipaint({"compare", stack.out("a.exr"), stack.path(), "--out", stack.out("c")});
        ASSERT_TRUE(ended(compared, 0));
        const double psnr = compared.json()["mean"]["all"]["psnr_db"];
        EXPECT_GT(psnr, 25) << unit;
        EXPECT_LT(psnr, 60) << unit;
        // A picture for people is neither black nor white.
        ASSERT_TRUE(ended(
            tangipaint({"relight", stack.out("a.exr"), "--light", "0,0,1", "--out", stack.out("p.png")}), 0));
        double mean = 0;
        const Image<Rgb> picture = read_picture(stack.out("p.png"));
        for (const Rgb& pixel : picture.pixels())
            mean += static_cast<double>(pixel.g) / static_cast<double>(picture.size());
        EXPECT_GT(mean, 0.1) << unit;
        EXPECT_LT(mean, 0.9) << unit;
    }
}

std::string sixteen_bits(const Rgb& pixel) {
    std::string bytes;
    for (int c = 0; c < 3; ++c) {
        const auto code = static_cast<unsigned>(std::lround(65535 * std::clamp(pixel[c], 0.0f, 1.0f)));
        bytes += static_cast<char>(code & 255);
        bytes += static_cast<char>(code >> 8);
    }
    return bytes;
}

TiffPicture tiff_picture(const Image<Rgb>& photo) {
    TiffPicture picture{.width = photo.width(), .height = photo.height(), .bits = 16, .bytes = {}};
    for (const Rgb& pixel : photo.pixels()) picture.bytes += sixteen_bits(pixel);
    return picture;
}

TEST(CliStrangePhoto, IsATiffWhoseFirstPageIsAPreview) {
    const TinyStack stack;
    const Surface clean = fitted(stack, "clean.exr");
    for (int i = 0; i < 12; ++i) {
        const Image<Rgb> photo = read_picture(stack.photo(i));
        TiffPicture preview = even_tiff(8, 8, std::string("\x80\x80\x80", 3), 1);
        fs::remove(stack.photo(i));
        write_bytes(fs::path(stack.photo(i)).replace_extension(".tif"),
                    tiff_of({preview, tiff_picture(photo)}));
    }
    const Surface surface = fitted(stack, "a.exr");
    EXPECT_EQ(surface.width(), clean.width());
    EXPECT_TRUE(images_identical(surface.normal, clean.normal));
}

TEST(CliStrangePhoto, IsOfSixBands) {
    const TinyStack stack;
    for (int i = 0; i < 12; ++i) {
        const Image<Rgb> photo = read_picture(stack.photo(i));
        TiffPicture bands = tiff_picture(photo);
        bands.samples = 6;
        bands.bytes.clear();
        for (const Rgb& pixel : photo.pixels()) bands.bytes += sixteen_bits(pixel) + sixteen_bits(pixel);
        fs::remove(stack.photo(i));
        write_bytes(fs::path(stack.photo(i)).replace_extension(".tif"), tiff_of({bands}));
    }
    expect_refused(stack, {"has 6 channels", "which are red, green and blue", "store red, green and blue"});
}

TEST(CliStrangePhoto, IsAJpegWithAFilmBehindIt) {
    const TinyStack stack([](GeneratorOptions& o) { o.format = GeneratorFormat::jpg; });
    const Surface clean = fitted(stack, "clean.exr");
    for (int i = 0; i < 12; ++i)
        write_bytes(stack.photo(i), bytes_of(stack.photo(i)) +
                                        std::string("\0\0\0\x18"
                                                    "ftypmp42",
                                                    12) +
                                        std::string(120000, '\0'));
    EXPECT_TRUE(images_identical(fitted(stack, "a.exr").normal, clean.normal));
}

TEST(CliStrangePhoto, LiesInTheFolderThatWasNamed) {
    const TinyStack stack;
    const Surface clean = fitted(stack, "clean.exr");
    const fs::path old = stack.out("old");
    fs::create_directory(old);
    std::string list = "12\n";
    std::istringstream lights(bytes_of(fs::path(stack.path()) / "lights.lp"));
    std::string line;
    std::getline(lights, line);
    while (std::getline(lights, line))
        if (!line.empty()) list += old.string() + "/" + line + "\n";
    write_bytes(fs::path(stack.path()) / "lights.lp", list);
    for (int i = 0; i < 12; ++i) {  // an earlier state, upside down
        const Image<Rgb> photo = read_picture(stack.photo(i));
        Image<Rgb> turned(photo.width(), photo.height());
        for (int y = 0; y < photo.height(); ++y)
            std::ranges::copy(photo.row(photo.height() - 1 - y), turned.row(y).begin());
        write_picture(old / stack.name(i), turned, {});
    }
    expect_warned(stack,
                  {"lists 12 of 12 photographs in another folder", old.string(), "as that folder was named"});
    EXPECT_TRUE(images_identical(fitted(stack, "b.exr").normal, clean.normal));
}

// Pixels that say that they are not square make the result poor, of both commands.
TEST(CliStrangePhoto, HasPixelsThatAreNotSquare) {
    const TinyStack stack;
    const std::string squares = png_chunk_of("pHYs", be32(2000) + be32(1000) + "\1");  // pixels a metre
    constexpr std::size_t behind_size = 33;                                            // signature and IHDR
    for (int i = 0; i < 12; ++i) {
        const std::string bytes = read_text_file(stack.photo(i));
        write_bytes(stack.photo(i), bytes.substr(0, behind_size) + squares + bytes.substr(behind_size));
    }
    const std::vector<std::string> words = {"0.5 times as wide as they are high", "resample"};
    const Finished fit = tangipaint({"fit", stack.path(), "--out", stack.out("a.exr")});
    EXPECT_TRUE(ended(fit, 3, words));
    EXPECT_FALSE(fit.json()["poor"].empty());
    const Finished compare =
        tangipaint({"compare", stack.out("a.exr"), stack.path(), "--out", stack.out("c")});
    EXPECT_TRUE(ended(compare, 3, words));
    EXPECT_FALSE(compare.json()["poor"].empty());
}

}  // namespace
}  // namespace tangi
