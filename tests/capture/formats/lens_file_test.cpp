// Lenses: files as OpenCV writes them, what can be wrong with them, and distortion there and back.
#include "capture/formats/lens_file.h"

#include <gmock/gmock.h>

#include <opencv2/core.hpp>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

using glm::dvec2;
using testing::HasSubstr;

std::string yaml(const std::string& distortion = "[ -0.2, 0.05, 1e-3, -5e-4, 0. ]", int count = 5,
                 int width = 640, int height = 480) {
    return fmt::format(
        "%YAML:1.0\n---\nimage_width: {}\nimage_height: {}\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   "
        "cols: 3\n"
        "   dt: d\n   data: [ 800., 0., 325.5, 0., 790., 236.25, 0., 0., 1. ]\n"
        "distortion_coefficients: !!opencv-matrix\n   rows: {}\n   cols: 1\n   dt: d\n   data: {}\n",
        width, height, count, distortion);
}

Lens lens_of(const std::string& text) {
    const TestDir dir;
    write_bytes(dir / "lens.yml", text);
    return read_lens(dir / "lens.yml");
}

TEST(LensFile, IsReadFromYamlAndXml) {
    const TestDir dir;
    write_bytes(dir / "a.yml", yaml());
    {
        cv::FileStorage file((dir / "b.xml").string(), cv::FileStorage::WRITE);
        const cv::Mat camera = (cv::Mat_<double>(3, 3) << 800, 0, 325.5, 0, 790, 236.25, 0, 0, 1);
        const cv::Mat distortion = (cv::Mat_<double>(1, 5) << -0.2, 0.05, 1e-3, -5e-4, 0);
        file << "image_width" << 640 << "image_height" << 480 << "camera_matrix" << camera
             << "distortion_coefficients" << distortion;
    }
    for (const char* name : {"a.yml", "b.xml"}) {
        const Lens lens = read_lens(dir / name);
        EXPECT_EQ(lens.width, 640);
        EXPECT_EQ(lens.height, 480);
        EXPECT_EQ(lens.focal_px, dvec2(800, 790));
        EXPECT_EQ(lens.principal_px, dvec2(325.5, 236.25));
        EXPECT_THAT(lens.distortion, testing::ElementsAre(-0.2, 0.05, 1e-3, -5e-4, 0));
    }
}

TEST(LensFile, ThatIsWrongIsAnErrorWithThePlace) {
    const TestDir dir;
    const auto error = [&](const std::string& name, const std::string& text) {
        write_bytes(dir / name, text);
        return error_of([&] { read_lens(dir / name); });
    };
    const std::string whole = yaml();
    // Cut off anywhere, it is an Error that names the file, or, where only a last zero is missing, the same
    // lens.
    for (std::size_t length = 0; length + 25 < whole.size(); length += 7)
        EXPECT_THAT(error("cut.yml", whole.substr(0, length)), HasSubstr("cut.yml: ")) << length;
    EXPECT_THAT(error("a.yml", "%YAML:1.0\n---\nimage_width: 640\n"),
                HasSubstr("a.yml: has no camera_matrix"));
    EXPECT_THAT(error("b.yml", yaml("[ 0., 0., 0. ]", 3)),
                HasSubstr("has 3 numbers instead of 4, 5, 8, 12 or 14"));
    EXPECT_THAT(error("c.yml", yaml("[ 0., 0., 0., 0., 0. ]", 5, -3)), HasSubstr("has no image_width"));
    EXPECT_THAT(error("d.yml", yaml("[ 0., 0., 0., 0., 0. ]", 5, 300)),
                HasSubstr("principal point (325.5, 236.2)"));
    EXPECT_THAT(error("e.yml", yaml("[ .Nan, 0., 0., 0., 0. ]", 5)), HasSubstr("not finite"));
    EXPECT_THAT(error("f.xml", "not xml at all"), HasSubstr("f.xml: "));
    EXPECT_THAT(error("g.txt", whole), HasSubstr("is read from .yml, .yaml or .xml"));
    EXPECT_THAT(error_of([&] { read_lens(dir / "none.yml"); }), HasSubstr("none.yml: there is no such file"));
    EXPECT_THAT(error("i.yml", yaml("[ -8., 0., 0., 0., 0. ]")),
                HasSubstr("i.yml: its distortion turns back 109 pixels from the middle"));
    EXPECT_EQ(lens_of(yaml("[ -0.4, 0.15, 0., 0., 0. ]")).distortion.size(), 5u);  // a strong barrel
    std::string lying = whole;
    lying.replace(lying.find("camera_matrix: !!opencv-matrix\n   rows: 3"), 41,
                  "camera_matrix: !!opencv-matrix\n   rows: 2");
    EXPECT_THAT(error("h.yml", lying), HasSubstr("h.yml: "));
}

TEST(LensFile, WithAnEmptyNameIsAnError) {
    std::string text = yaml();
    const std::string rows = "   rows: 5\n";
    text.insert(text.find(rows) + rows.size(), "   : d\n");
    EXPECT_THAT(error_of([&] { lens_of(text); }),
                testing::AllOf(HasSubstr("lens.yml: line 12: "),
                               HasSubstr("a calibration file of OpenCV, and whole")));
}

std::string xml(const std::string& distortion) {
    return "<?xml version=\"1.0\"?>\n<opencv_storage>\n<!-- of <my> lens "
           "-->\n<image_width>640</image_width>\n"
           "<image_height>480</image_height>\n<camera_matrix type_id=\"opencv-matrix\">\n<rows>3</rows>\n"
           "<cols>3</cols>\n<dt>d</dt>\n<data>\n800. 0. 325.5 0. 790. 236.25 0. 0. "
           "1.</data></camera_matrix>\n" +
           distortion + "\n</opencv_storage>\n";
}
const std::string kXmlDistortion =
    "<distortion_coefficients type_id=\"opencv-matrix\"><rows>5</rows><cols>1</cols><dt>d</dt>"
    "<data>-0.2 0.05 0. 0. 0.</data></distortion_coefficients>";

// OpenCV's own reader ends the process at some of these.
TEST(LensFile, OfXmlThatIsDamagedIsAnErrorWithThePlace) {
    const TestDir dir;
    const auto error = [&](const std::string& text) {
        write_bytes(dir / "a.xml", text);
        return error_of([&] { read_lens(dir / "a.xml"); });
    };
    const std::string whole = xml(kXmlDistortion);
    write_bytes(dir / "whole.xml", whole);
    EXPECT_EQ(read_lens(dir / "whole.xml").distortion.size(), 5u);
    for (std::size_t length = 0; length + 3 < whole.size(); length += 5)
        EXPECT_THAT(error(whole.substr(0, length)), HasSubstr("a.xml: ")) << length;
    EXPECT_THAT(error(xml("<distortion_coefficients><rows>5</rows><cols>1</cols><dt>d</dt><data>0.1 0. "
                          "\xc0\xc1\xff"
                          "a></distortion_coefficients>")),
                HasSubstr("a.xml: line "));
    EXPECT_THAT(error(xml("<distortion_coefficients><rows>2000000000</rows><cols>2000000000</cols><dt>d</dt>"
                          "<data>0.1</data></distortion_coefficients>")),
                HasSubstr("distortion_coefficients: has no rows"));
    EXPECT_THAT(error(xml("<distortion_coefficients><rows>5</rows><cols>1</cols><dt>3d</dt>"
                          "<data>0.1</data></distortion_coefficients>")),
                HasSubstr("is no matrix of numbers"));
    EXPECT_THAT(error(xml("<distortion_coefficients><rows>5</rows><cols>1</cols><dt>d</dt>"
                          "<data>0.1 0 0 0Z 0</data></distortion_coefficients>")),
                HasSubstr("distortion_coefficients: '0Z' is no number"));
    EXPECT_THAT(error(xml("<distortion_coefficients><rows>6</rows><cols>1</cols><dt>d</dt>"
                          "<data>0.1 0 0 0 0</data></distortion_coefficients>")),
                HasSubstr("is 6 x 1 by its rows and cols, and has 5 numbers"));
    std::string nested;
    for (int i = 0; i < 100'000; ++i) nested += "<a>";
    EXPECT_THAT(error(nested), HasSubstr("deeper than 16"));
}

// As OpenCV's calibration program writes it, with more than is needed.
TEST(LensFile, OfYamlMayHoldMore) {
    const Lens lens = lens_of(
        "%YAML:1.0\n---\ncalibration_time: \"Thu 05 Nov 2026 10:21:07\"\nnr_of_frames: 13 # all of them\n"
        "image_width: 640\nimage_height: 480\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: "
        "d\n"
        "   data: [ 800., 0., 325.5, 0., 790.,\n       236.25, 0., 0., 1. ]\n"
        "distortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: f\n   data: [ -2.0e-01, "
        "0.05,\n"
        "       1.0000000000000000e-03, -5e-4, 0. ]\nflags:\n   - 1\n   - { a: 1 }\n"
        "avg_reprojection_error: 2.4e-01\n");
    EXPECT_THAT(lens.distortion, testing::ElementsAre(-0.2, 0.05, 1e-3, -5e-4, 0));
    EXPECT_EQ(lens.principal_px, dvec2(325.5, 236.25));
}

TEST(Lens, DistortsAndUndistortsBackAndForth) {
    const Lens lens = lens_of(yaml());
    const Image<glm::vec2> map = undistortion_map(lens, 640, 480);
    double most = 0;
    for (int y = 5; y < 480; y += 47)
        for (int x = 5; x < 640; x += 61) {
            const dvec2 seen = undistorted(lens, dvec2(map(x, y)));
            EXPECT_LT(glm::length(seen - dvec2(x, y)), 2e-3) << x << " " << y;
            most = std::max(most, double(glm::length(map(x, y) - glm::vec2(x, y))));
        }
    EXPECT_GT(most, 5);  // there is something to undo
    const glm::vec2 middle = map(325, 236);
    EXPECT_LT(glm::length(middle - glm::vec2(325, 236)), 0.5);
}

TEST(Lens, AgreesWithBrownsFormula) {
    const Lens lens = lens_of(yaml());
    const Image<glm::vec2> map = undistortion_map(lens, 640, 480);
    const double k1 = -0.2, k2 = 0.05, p1 = 1e-3, p2 = -5e-4;
    for (const auto& [px, py] : {std::pair(20, 30), std::pair(600, 440), std::pair(320, 10)}) {
        const double x = (px - 325.5) / 800, y = (py - 236.25) / 790, r2 = x * x + y * y;
        const double radial = 1 + k1 * r2 + k2 * r2 * r2;
        const double dx = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x);
        const double dy = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y;
        EXPECT_NEAR(map(px, py).x, 800 * dx + 325.5, 1e-3);
        EXPECT_NEAR(map(px, py).y, 790 * dy + 236.25, 1e-3);
    }
}

TEST(Lens, WithoutDistortionChangesNothing) {
    const Lens lens = lens_of(yaml("[ 0., 0., 0., 0. ]", 4));
    Image<Rgb> picture(640, 480);
    for (int y = 0; y < 480; ++y)
        for (int x = 0; x < 640; ++x) picture(x, y) = Rgb(x / 640.0f, y / 480.0f, 0.5f);
    const Image<Rgb> same = through_map(picture, undistortion_map(lens, 640, 480));
    for (int y = 2; y < 478; y += 13)
        for (int x = 2; x < 638; x += 17) EXPECT_LT(glm::length(same(x, y) - picture(x, y)), 1e-3);
}

TEST(Lens, IsScaledToReducedPicturesAndToNoOthers) {
    const Lens lens = lens_of(yaml());
    const Image<glm::vec2> whole = undistortion_map(lens, 640, 480), half = undistortion_map(lens, 320, 240);
    // A pixel of the half picture is the middle of four.
    for (int y = 10; y < 240; y += 50)
        for (int x = 10; x < 320; x += 60) {
            const glm::vec2 mean = 0.25f * (whole(2 * x, 2 * y) + whole(2 * x + 1, 2 * y) +
                                            whole(2 * x, 2 * y + 1) + whole(2 * x + 1, 2 * y + 1));
            EXPECT_LT(glm::length(half(x, y) - (0.5f * (mean + 0.5f) - 0.5f)), 2e-3);
        }
    EXPECT_THAT(error_of([&] { undistortion_map(lens, 480, 640); }),
                HasSubstr("calibrated with pictures of 640 x 480 pixels, which are not these of 480 x 640"));
    EXPECT_THAT(error_of([&] { undistortion_map(lens, 640, 400); }), HasSubstr("640 x 400"));
}

}  // namespace
}  // namespace tangi
