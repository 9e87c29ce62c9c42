// ora_file_test.cpp: layers as pictures, and OpenRaster files that other programs open.
#include "paint/files/ora_file.h"

#include <gmock/gmock.h>
#include <zip.h>

#include "paint/canvas/layer_pictures.h"
#include "paint/files/canvas_file.h"
#include "surface/base/json_reading.h"
#include "surface/image_file/image_io.h"
#include "tests/support/paint/paint_support.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

// Two dried layers, one of them a glaze, and wet paint that overlaps both.
Canvas layered() {
    Canvas canvas = flat_canvas(96, 64);
    const auto put = [&](const std::string& name, double medium, PathPoint from, PathPoint to) {
        PaintFinish finish;
        finish.medium = medium;
        const auto id = canvas.add(finished(artist_acrylics().at(name), finish));
        Brush brush(brush_presets().at("round"), kTestPixel, 7);
        brush.load({{id, 1}}, 1);
        stroke(canvas, brush, from, to);
    };
    put("Titanium White", 0, {-9, -3}, {9, -3});
    dry(canvas, "under <1>");
    put("Ultramarine Blue", 0.95, {-4, -7}, {-4, 7});
    dry(canvas, "glaze");
    put("Pyrrole Red", 0, {-9, 4}, {9, -6});
    return canvas;
}

TEST(LayerPictures, LaidOverEachOtherAreTheAppearance) {
    const Canvas canvas = layered();
    const auto layers = layer_pictures(canvas);
    ASSERT_EQ(layers.size(), 4u);
    EXPECT_EQ(layers[1].name, "under <1>");
    const Image<Rgb> merged = laid_over(layers), wanted = appearance(canvas).diffuse;
    const Transfer srgb{Transfer::Kind::srgb};
    for (std::size_t i = 0; i < merged.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            ASSERT_NEAR(merged.pixels()[i][c], srgb.encode(wanted.pixels()[i])[c], 1e-4) << i;
            ASSERT_GE(merged.pixels()[i][c], 0);
        }
    for (const LayerPicture& layer : layers)
        for (std::size_t i = 0; i < merged.size(); ++i) {
            const float alpha = layer.alpha.pixels()[i];
            ASSERT_TRUE(alpha >= 0 && alpha <= 1);
            const bool bare = !layer.thickness_mm.empty() && layer.thickness_mm.pixels()[i] == 0;
            ASSERT_TRUE(!bare || alpha == 0);
        }
    // Each ingredient's planes add up to the layer.
    Image<float> sum(canvas.width(), canvas.height());
    for (std::size_t k = 0; k < canvas.ingredients().size(); ++k) {
        const auto id = static_cast<IngredientId>(k);
        const Image<float> mm = thickness_mm_of(canvas.wet(), id);
        for (std::size_t i = 0; i < sum.size(); ++i) sum.pixels()[i] += mm.pixels()[i];
    }
    EXPECT_TRUE(images_near(sum, layers[3].thickness_mm, 1e-6));
}

class Unzipped {
public:
    explicit Unzipped(const std::filesystem::path& path) : zip_(zip_open(path.c_str(), ZIP_RDONLY, nullptr)) {
        if (!zip_) throw std::runtime_error("not a zip file");
        for (zip_int64_t i = 0; i < zip_get_num_entries(zip_, 0); ++i)
            names.emplace_back(zip_get_name(zip_, static_cast<zip_uint64_t>(i), 0));
    }
    ~Unzipped() { zip_discard(zip_); }
    std::string operator[](const std::string& name) const {
        zip_stat_t about;
        if (zip_stat(zip_, name.c_str(), 0, &about) != 0) return {};
        std::string bytes(about.size, '\0');
        zip_file_t* file = zip_fopen(zip_, name.c_str(), 0);
        if (!file || zip_fread(file, bytes.data(), about.size) != static_cast<zip_int64_t>(about.size))
            bytes = {};
        if (file) zip_fclose(file);
        return bytes;
    }
    std::vector<std::string> names;

private:
    zip_t* zip_;
};

TEST(OraFile, IsAnOpenRasterFileWithThePaintingInIt) {
    const TestDir dir;
    const Canvas canvas = layered();
    PartToWrite other;
    other.info = {"palette", 3, 2, {"x"}, {}};
    other.fill = [](int, int, std::span<float* const> planes) { planes[0][0] = 7; };
    {
        AtomicFile file(dir / "a.ora");
        write_ora(file, canvas, {}, {&other, 1});
    }
    // Programs tell it by its first member, which is stored as it is.
    EXPECT_EQ(bytes_of(dir / "a.ora").substr(30, 8 + 16), "mimetypeimage/openraster");
    const Unzipped ora(dir / "a.ora");
    EXPECT_THAT(ora.names,
                ElementsAre("mimetype", "stack.xml", "data/layer0.png", "data/layer1.png", "data/layer2.png",
                            "data/layer3.png", "mergedimage.png", "Thumbnails/thumbnail.png",
                            "tangipaint/height.png", "tangipaint/painting.json", "tangipaint/painting.exr"));
    const std::string stack = ora["stack.xml"];
    EXPECT_THAT(stack, HasSubstr("w=\"96\" h=\"64\""));
    EXPECT_THAT(stack, HasSubstr("under &lt;1&gt;"));
    EXPECT_LT(stack.find("layer3.png"), stack.find("layer0.png"));  // the topmost comes first

    write_bytes(dir / "merged.png", ora["mergedimage.png"]);
    const Image<Rgb> merged = read_picture(dir / "merged.png");
    EXPECT_TRUE(images_near(merged, laid_over(layer_pictures(canvas)), 0.5 / 255 + 1e-4));
    write_bytes(dir / "thumbnail.png", ora["Thumbnails/thumbnail.png"]);
    EXPECT_LE(read_picture(dir / "thumbnail.png").width(), 256);

    const auto about = read_json(ora["tangipaint/painting.json"], "JSON");
    EXPECT_EQ(about["layers"].size(), 3u);
    EXPECT_GT(about["height_high_mm"], 0.05);
    const auto& glaze = about["layers"][1]["paint"][0];
    EXPECT_EQ(glaze["paint"], "Ultramarine Blue");
    EXPECT_FALSE(glaze["origin"].get<std::string>().empty());
    EXPECT_NEAR(glaze["paint_mm3"].get<double>(), 0.05 * glaze["mm3"].get<double>(), 1e-6);
    EXPECT_EQ(about["height_unit"], "mm");
    // Floats are written as short as they are exact.
    const std::string specular = about["layers"][0]["paint"][0]["specular"].dump();
    EXPECT_LE(specular.size(), 6u) << specular;
    EXPECT_LE(about["height_high_mm"].dump().size(), 12u) << about["height_high_mm"];
    write_bytes(dir / "height.png", ora["tangipaint/height.png"]);
    const Image<Rgb> height = read_picture(dir / "height.png");
    const Surface painted = appearance(canvas);
    const double low = about["height_low_mm"], high = about["height_high_mm"];
    for (int y = 0; y < 64; y += 7)
        for (int x = 0; x < 96; x += 7)
            EXPECT_NEAR(low + (high - low) * height(x, y).r, painted.height_mm(x, y), (high - low) / 60000);
    write_bytes(dir / "painting.exr", ora["tangipaint/painting.exr"]);
    const Canvas again = read_canvas(dir / "painting.exr");
    EXPECT_TRUE(identical(again.wet(), canvas.wet()));
    EXPECT_EQ(again.dried().size(), 2u);
    const auto parts = painting_parts(dir / "painting.exr");
    EXPECT_TRUE(std::ranges::any_of(parts, [](const PartInfo& part) { return part.name == "palette"; }))
        << "it is the whole painting file";
    // Nothing else stays beside it.
    int files = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(dir.path())) ++files;
    EXPECT_EQ(files, 5);
}

TEST(OraFile, AFullDiskLeavesNothing) {
    const TestDir dir;
    const Canvas canvas = layered();
    {
        AtomicFile file(dir / "a.ora");
        const FullDisk full(2000);
        EXPECT_THAT(error_of([&] { write_ora(file, canvas); }),
                    StartsWith((dir / "a.ora").string() + ": cannot be written"));
    }
    EXPECT_TRUE(std::filesystem::is_empty(dir.path()));
}

}  // namespace
}  // namespace tangi
