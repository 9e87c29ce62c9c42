#include "fit/exchange/ptm_rti_file.h"

#include <gmock/gmock.h>

#include <cstring>

#include "surface/image/metrics.h"
#include "surface/image_file/image_io.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::HasSubstr;

// A picture of reliefs: coefficients that differ from pixel to pixel, a few far from all others.
RtiImage example(RtiBasis basis, bool lrgb, int width = 40, int height = 30) {
    RtiImage image{basis, lrgb, width, height, {}, {}};
    image.coefficients.resize(static_cast<std::size_t>(width * height) * image.stride());
    const auto terms = static_cast<std::size_t>(terms_of(basis)),
               constant = basis == RtiBasis::ptm ? std::size_t(5) : 0;
    Random random(11);
    for (std::size_t i = 0; i < image.coefficients.size(); ++i)
        image.coefficients[i] = i % terms == constant ? random.real(0.3, 0.9) : random.real(-0.3, 0.3);
    image.coefficients[1] = 5;
    image.coefficients[image.stride() * 3 + 2] = -4;
    if (lrgb) {
        image.colour = Image<Rgb>(width, height);
        for (Rgb& c : image.colour.pixels()) c = Rgb(1, random.real(), random.real());
    }
    return image;
}

void write(const std::filesystem::path& path, const RtiImage& image) {
    AtomicFile file(path);
    write_rti_file(file, image);
}

TEST(RtiFile, RoundTripsAreFaithful) {
    const TestDir dir;
    for (const auto& [basis, lrgb, name] :
         {std::tuple(RtiBasis::ptm, false, "a.ptm"), std::tuple(RtiBasis::ptm, true, "b.ptm"),
          std::tuple(RtiBasis::hsh4, false, "c.rti"), std::tuple(RtiBasis::hsh9, false, "d.rti"),
          std::tuple(RtiBasis::hsh16, false, "e.rti")}) {
        const RtiImage image = example(basis, lrgb);
        write(dir / name, image);
        const RtiImage back = read_rti_file(dir / name);
        EXPECT_EQ(back.basis, basis);
        EXPECT_EQ(back.lrgb, lrgb);
        EXPECT_EQ(back.width, 40);
        EXPECT_EQ(back.height, 30);
        for (const Vec3& light : {Vec3(0, 0, 1), Vec3(0.6f, 0, 0.8f), Vec3(-0.3f, 0.9f, 0.3f)})
            EXPECT_GT(psnr_db(evaluate(image, glm::normalize(light)), evaluate(back, glm::normalize(light))),
                      38)
                << name;
    }
}

TEST(RtiFile, LayoutIsTheOneThatViewersRead) {
    const TestDir dir;
    RtiImage image = example(RtiBasis::ptm, false, 3, 2);
    image.coefficients.assign(image.coefficients.size(), 0.0f);
    // Red, u, of the pixel at the bottom left, which the file has first.
    image.coefficients[3 * image.stride() + 3] = 1;
    write(dir / "a.ptm", image);
    const std::string ptm = bytes_of(dir / "a.ptm");
    const std::string head = "PTM_1.2\nPTM_FORMAT_RGB\n3\n2\n";
    ASSERT_EQ(ptm.substr(0, head.size()), head);
    EXPECT_EQ(ptm.size() - (ptm.find('\n', ptm.find('\n', head.size()) + 1) + 1), 3u * 2 * 18);
    const std::string data = ptm.substr(ptm.size() - 3 * 2 * 18);
    EXPECT_EQ(static_cast<unsigned char>(data[3]), 255);
    EXPECT_EQ(std::count(data.begin(), data.end(), static_cast<char>(255)), 1);

    RtiImage hsh = example(RtiBasis::hsh4, false, 3, 2);
    hsh.coefficients.assign(hsh.coefficients.size(), 0.0f);
    hsh.coefficients[4 * 1 + 2] = 0.5f;  // green, third harmonic, top left
    write(dir / "a.rti", hsh);
    const std::string rti = bytes_of(dir / "a.rti");
    const std::string hsh_head = "#HSH1.2\n3\n3 2 3\n4 2 1\n";
    ASSERT_EQ(rti.substr(0, hsh_head.size()), hsh_head);
    ASSERT_EQ(rti.size(), hsh_head.size() + 8 * 4 + 3 * 2 * 12);
    float scale = 0;
    std::memcpy(&scale, rti.data() + hsh_head.size() + 8, 4);
    EXPECT_FLOAT_EQ(scale, 0.5f);
    EXPECT_EQ(static_cast<unsigned char>(rti[hsh_head.size() + 32 + 6]), 255);
}

TEST(RtiFile, BadFilesAreErrors) {
    const TestDir dir;
    const auto read = [&](const std::string& bytes) {
        write_bytes(dir / "x.ptm", bytes);
        return error_of([&] { read_rti_file(dir / "x.ptm"); });
    };
    EXPECT_THAT(read("PNG"), HasSubstr("x.ptm: is no .ptm"));
    EXPECT_THAT(read("PTM_1.2\nPTM_FORMAT_JPEG_LRGB\n3\n2\n"), HasSubstr("PTM_FORMAT_JPEG_LRGB"));
    EXPECT_THAT(read("PTM_1.2\nPTM_FORMAT_RGB\n3"), HasSubstr("header is damaged"));
    EXPECT_THAT(read("PTM_1.2\nPTM_FORMAT_RGB\n3000000000\n2\n"), HasSubstr("pixels"));
    EXPECT_THAT(read("PTM_1.2\nPTM_FORMAT_RGB\n3 2\n1 1 1 x 1 1\n"), HasSubstr("'x'"));
    EXPECT_THAT(read("PTM_1.2\nPTM_FORMAT_RGB\n300000 200000\n1 1 1 1 1 1\n0 0 0 0 0 0\nabc"),
                HasSubstr("is cut off"));
    EXPECT_THAT(read("#HSH1.2\n3\n3 2 3\n5 2 1\n"), HasSubstr("has 5 terms"));
    EXPECT_THAT(read("#HSH1.2\n3\n3 2 3\n4 2 1\nabc"), HasSubstr("is cut off"));
    EXPECT_THAT(error_of([&] { write(dir / "a.rti", example(RtiBasis::ptm, false)); }), HasSubstr(".ptm"));
    EXPECT_EQ(names_in(dir.path()), std::vector<std::string>{"x.ptm"});
}

// The leading tool loses 19 dB.
TEST(DataRti, APtmFileOfARealStackLosesLessThanHalfADecibel) {
    TP_DATA(folder, "real/door");
    Stack stack = open_stack(folder);
    hold_out(stack, "4:8");
    const TestDir dir;
    for (const bool lrgb : {false, true}) {
        const RtiImage image = fit_rti(stack, RtiBasis::ptm, lrgb);
        write(dir / "a.ptm", image);
        const RtiImage back = read_rti_file(dir / "a.ptm");
        double floats = 0, bytes = 0;
        for (const StackPhoto& photo : stack.held_out) {
            const Image<Rgb> taken = read_picture(photo.path);
            floats += psnr_db(taken, evaluate(image, photo.light.direction)) /
                      static_cast<double>(stack.held_out.size());
            bytes += psnr_db(taken, evaluate(back, photo.light.direction)) /
                     static_cast<double>(stack.held_out.size());
        }
        std::cout << fmt::format("[  FIGURE  ] door ptm{}: {:.2f} dB, as a file {:.2f} dB\n",
                                 lrgb ? " lrgb" : "", floats, bytes);
        EXPECT_GT(bytes, floats - 0.5);
    }
}

}  // namespace
}  // namespace tangi
