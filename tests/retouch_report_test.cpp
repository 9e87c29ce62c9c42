// retouch_report_test.cpp: what the report says, and what other programs read of it.
#include "paint/retouch/treatment_report.h"

#include <gmock/gmock.h>

#include "paint/retouch/fill.h"
#include "paint/retouch/treatment_picture.h"
#include "surface/atomic_file.h"
#include "surface/error.h"
#include "surface/painting_file.h"
#include "tests/paint_support.h"
#include "tests/test_support.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

const Author kAuthor{"A. <Restorer>", "tangipaint test"};

class Report : public testing::Test {
protected:
    Report() {
        auto surface = flat_surface(90, 60);
        for (int y = 20; y < 40; ++y)
            for (int x = 30; x < 60; ++x) surface->height_mm(x, y) = -0.3f;
        write_painting(dir_ / "p.exr", *surface);
        Treatment treatment = Treatment::begin(folder(), dir_ / "p.exr", kAuthor);
        const Mask loss = mask_of_polygons({{{30, 20}, {60, 20}, {60, 40}, {30, 40}}}, 90, 60);
        treatment.record({.action = "draw", .masks = {{"loss_to_ground", loss}}}, kAuthor);
        Canvas canvas = treatment.read_canvas();
        lay_fill(canvas, "fill 1", loss, {}, FillTexture::smooth, Rgb(0.8f));
        treatment.record({.action = "fill",
                          .parameters = {{"texture", "smooth"}},
                          .canvas = &canvas,
                          .added = {{"fill 1", LayerRole::fill}}},
                         kAuthor);
    }
    std::filesystem::path folder() const { return dir_ / "p.treatment"; }

    TestDir dir_;
};

TEST_F(Report, SaysWhatWasDoneAndByWhomAndWithWhichHashes) {
    const Treatment treatment = Treatment::open(folder());
    const auto files = write_treatment_report(treatment, dir_ / "report.html", "tangipaint test");
    EXPECT_EQ(files.size(), 7u);
    for (const auto& file : files) EXPECT_GT(std::filesystem::file_size(file), 100u) << file;
    const std::string page = read_text_file(dir_ / "report.html");
    EXPECT_THAT(page, AllOf(HasSubstr("Identification"), HasSubstr("Condition"), HasSubstr("Measures"),
                            HasSubstr("A. &lt;Restorer&gt;"), HasSubstr(treatment.log().head()),
                            HasSubstr(treatment.dry_sha256()), HasSubstr(treatment.layers()[0].sha256)));
    EXPECT_THAT(page, AllOf(HasSubstr("0.38 cm²"), HasSubstr("before, normal light"),
                            HasSubstr("filled, raking from the left"), HasSubstr("@page")));
    // Printed at scale.
    EXPECT_THAT(read_text_file(dir_ / "report.mask.white.html"),
                AllOf(HasSubstr("width:22.50mm;height:15.00mm"), HasSubstr("M"), HasSubstr("20 mm")));
    EXPECT_THAT(read_text_file(dir_ / "report.mask.colour.html"),
                HasSubstr("<rect x=\"30\" y=\"20\" width=\"30\""));
}

TEST_F(Report, IsNotMadeOfATreatmentThatWasTamperedWith) {
    const Treatment treatment = Treatment::open(folder());
    write_mask(folder() / "masks/loss_to_ground.png", Mask(90, 60));
    EXPECT_THAT([&] { write_treatment_report(treatment, dir_ / "report.html", ""); },
                ThrowsMessage<Error>(AllOf(HasSubstr("no report"), HasSubstr("loss_to_ground.png"))));
    EXPECT_FALSE(std::filesystem::exists(dir_ / "report.html"));
}

TEST_F(Report, DamageIsOnAnIiifCanvasAsWebAnnotations) {
    const Treatment treatment = Treatment::open(folder());
    const nlohmann::json page = web_annotations(treatment, "picture.jpg");
    ASSERT_EQ(page.at("items").size(), 1u);
    const nlohmann::json& item = page["items"][0];
    EXPECT_EQ(item["type"], "Annotation");
    EXPECT_EQ(item["target"]["source"], "picture.jpg");
    EXPECT_EQ(item["target"]["selector"]["type"], "SvgSelector");
    EXPECT_EQ(item["body"][0]["value"], "loss to ground");
    EXPECT_THAT(item["target"]["selector"]["value"].get<std::string>(),
                AllOf(HasSubstr("<svg xmlns"), HasSubstr("30.0"), HasSubstr("60.0")));

    const nlohmann::json manifest = iiif_manifest(treatment, "picture.jpg");
    EXPECT_EQ(manifest["@context"], "http://iiif.io/api/presentation/3/context.json");
    EXPECT_TRUE(manifest["label"]["en"].is_array());
    ASSERT_EQ(manifest["items"].size(), 1u);
    const nlohmann::json& canvas = manifest["items"][0];
    EXPECT_EQ(canvas["width"], 90);
    EXPECT_EQ(canvas["items"][0]["items"][0]["body"]["id"], "picture.jpg");
    EXPECT_EQ(canvas["items"][0]["items"][0]["target"], canvas["id"]);
    EXPECT_EQ(canvas["annotations"][0]["type"], "AnnotationPage");
    EXPECT_EQ(canvas["annotations"][0]["items"][0]["target"]["source"]["id"], canvas["id"]);
}

TEST_F(Report, PicturesShowDamageAndAdditions) {
    const Treatment treatment = Treatment::open(folder());
    const Canvas canvas = treatment.read_canvas();
    EXPECT_TRUE(canvas.dried().at(0).levels);  // through the file
    const Image<Rgb> damage = damage_picture(treatment, canvas.dry());
    EXPECT_GT(damage.height(), 60);                        // the legend is below
    EXPECT_GT(damage(45, 30).r - damage(45, 30).b, 0.3f);  // orange
    EXPECT_NEAR(damage(5, 5).r, damage(5, 5).b, 1e-6);
    const Image<Rgb> additions = additions_picture(canvas, treatment.layers(), Mask(90, 60));
    EXPECT_GT(additions(45, 30).g - additions(45, 30).r, 0.2f);  // green
    EXPECT_NEAR(additions(5, 5).g, additions(5, 5).r, 1e-6);
    const Image<Rgb> look = look_of(canvas.dry(), distant_light({0, 0, 1}), 45);
    EXPECT_EQ(look.width(), 45);
}

}  // namespace
}  // namespace tangi
