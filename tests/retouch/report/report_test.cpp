// report_test.cpp: what the report says, and what other programs read of it.
#include "retouch/report/treatment_report.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>

#include "retouch/fill/fill.h"
#include "retouch/report/report_document.h"
#include "retouch/treatment/treatment_area.h"
#include "retouch/treatment/treatment_picture.h"
#include "retouch/treatment/treatment_steps.h"
#include "surface/base/error.h"
#include "surface/file/atomic_file.h"
#include "surface/file/version.h"
#include "surface/painting_file/painting_file.h"
#include "tests/support/paint/paint_support.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

const Author kAuthorToEscape{"A. <Restorer>", "tangipaint test"};

class Report : public testing::Test {
protected:
    Report() {
        auto surface = flat_surface(90, 60);
        for (int y = 20; y < 40; ++y)
            for (int x = 30; x < 60; ++x) surface->height_mm(x, y) = -0.3f;
        write_painting(dir_ / "p.exr", *surface);
        Treatment treatment = Treatment::begin(folder(), dir_ / "p.exr", kAuthorToEscape);
        const Mask loss = mask_of_polygons({{{30, 20}, {60, 20}, {60, 40}, {30, 40}}}, 90, 60);
        treatment.record({.action = "draw", .masks = {{"loss_to_ground", loss}}}, kAuthorToEscape);
        Canvas canvas = treatment.read_canvas();
        lay_fill(canvas, "fill 1", loss, {}, {FillTexture::smooth, Rgb(0.8f)});
        treatment.record({.action = "fill",
                          .parameters = {{"texture", "smooth"}},
                          .canvas = &canvas,
                          .added = {{"fill 1", LayerRole::fill}}},
                         kAuthorToEscape);
    }
    std::filesystem::path folder() const { return dir_ / "p.treatment"; }

    TestDir dir_;
};

TEST(StatedResults, WithoutAScaleAreInPixels) {
    const nlohmann::json results = {{"deepest_mm", 0.5},
                                    {"regions", {{{"area_mm2", 8}, {"height_step_mm", {{"rms", 0.1}}}}}},
                                    {"volumes_mm3", {{"white", 16}}},
                                    {"own", nullptr}};
    EXPECT_EQ(in_known_units(results, 2, true), results);
    const nlohmann::json expected = {{"deepest_px", 0.25},
                                     {"regions", {{{"area_px", 2.0}, {"height_step_px", {{"rms", 0.05}}}}}},
                                     {"volumes_px3", {{"white", 2.0}}},
                                     {"own", nullptr}};
    EXPECT_EQ(in_known_units(results, 2, false), expected);
    EXPECT_EQ(stated_length(expected, "deepest").unit, " px");
}

TEST_F(Report, SaysWhatWasDoneAndByWhomAndWithWhichHashes) {
    const Treatment treatment = Treatment::open(folder());
    const auto files = write_treatment_report(treatment, dir_ / "report.html", "tangipaint test");
    EXPECT_EQ(files.size(), 8u);
    for (const auto& file : files) EXPECT_GT(std::filesystem::file_size(file), 100u) << file;
    const std::string page = read_text_file(dir_ / "report.html");
    EXPECT_THAT(page, AllOf(HasSubstr("Identification"), HasSubstr("Condition"), HasSubstr("Measures"),
                            HasSubstr("A. &lt;Restorer&gt;"), HasSubstr(treatment.log().head()),
                            HasSubstr(treatment.dry_sha256()), HasSubstr(treatment.layers()[0].sha256)));
    EXPECT_THAT(page, AllOf(HasSubstr("0.38 cm²"), HasSubstr("before, normal light"),
                            HasSubstr("filled, raking from the left"), HasSubstr("@page")));
}

TEST_F(Report, CountsHeldOutPhotographsApart) {
    auto surface = flat_surface(90, 60);
    for (int i = 0; i < 5; ++i)
        surface->photography.photos.push_back(
            {.light = distant_light({0.1f * static_cast<float>(i), 0, 1}, fmt::format("{}.jpg", i)),
             .fitted = i != 3});
    const auto page_of = [&](const std::string& name) {
        write_painting(dir_ / (name + ".exr"), *surface);
        const Treatment treatment = Treatment::begin(dir_ / name, dir_ / (name + ".exr"), kAuthorToEscape);
        write_treatment_report(treatment, dir_ / (name + ".html"), "tangipaint test");
        return read_text_file(dir_ / (name + ".html"));
    };
    const std::string some = page_of("some");
    EXPECT_THAT(some,
                HasSubstr("of the 4 photographs that the maps were fitted from, and, as rings, of 1 more "
                          "that were held out; the middle"));
    EXPECT_THAT(some, testing::ContainsRegex("3.jpg: elevation [^<]*, held out</title>"));
    EXPECT_THAT(some, Not(testing::ContainsRegex("2.jpg: elevation [^<]*, held out</title>")));
    surface->photography.photos[3].fitted = true;
    EXPECT_THAT(page_of("none"), AllOf(HasSubstr("of the 5 photographs that the maps were fitted from; the"),
                                       Not(HasSubstr("held out"))));
}

// What a PDF says, by another program; lines end where the page does.
std::string text_of_pdf(const std::filesystem::path& pdf, const std::filesystem::path& scratch) {
    const std::string command = "pdftotext -raw '" + pdf.string() + "' '" + scratch.string() + "'";
    std::string text = std::system(command.c_str()) == 0 ? read_text_file(scratch) : "";
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
}

int count(const std::string& text, const std::string& word) {
    int n = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++n;
    return n;
}

TEST_F(Report, IsAPdfOfTextAndPictures) {
    if (std::system("command -v pdftotext >/dev/null 2>&1") != 0)
        GTEST_SKIP() << "pdftotext (poppler-utils) is not installed";
    const Treatment treatment = Treatment::open(folder());
    write_treatment_report(treatment, dir_ / "report.pdf", "tangipaint test");
    EXPECT_TRUE(std::filesystem::exists(dir_ / "report.html"));
    const std::string bytes = read_text_file(dir_ / "report.pdf");
    EXPECT_EQ(bytes.rfind("%PDF-", 0), 0u);
    EXPECT_EQ(count(bytes, "/DCTDecode"),
              9);  // damage, additions, 2 states x 3 illuminants, the mask in colour
    const std::string text = text_of_pdf(dir_ / "report.pdf", dir_ / "report.txt");
    EXPECT_THAT(text, AllOf(HasSubstr("1. Identification"), HasSubstr("6. Log"), HasSubstr("A. <Restorer>"),
                            HasSubstr(treatment.log().head()), HasSubstr("0.38 cm²"),
                            HasSubstr("before, normal light"), HasSubstr("Scale 1:1;")));
    const int pages = count(text, "\f");
    EXPECT_GE(pages, 4);
    for (int page = 1; page <= pages; ++page)
        EXPECT_THAT(text, HasSubstr(fmt::format("page {} of {}", page, pages)));
}

TEST_F(Report, MasksToPrintAreAsLargeAsThePainting) {
    const Treatment treatment = Treatment::open(folder());
    write_treatment_report(treatment, dir_ / "report.html", "tangipaint test");
    for (const char* name : {"report.mask.colour.pdf", "report.mask.white.pdf"}) {
        const std::string bytes = read_text_file(dir_ / name);
        // 22.5 x 15 mm, drawn in mm: 72/25.4 points each.
        EXPECT_THAT(bytes, HasSubstr("/MediaBox")) << name;
        if (std::system("command -v pdftotext >/dev/null 2>&1") == 0) {
            EXPECT_THAT(text_of_pdf(dir_ / name, dir_ / "mask.txt"),
                        AllOf(HasSubstr("Scale 1:1; the whole is 22.5 × 15.0 mm"),
                              HasSubstr("20 mm on the painting")));
        }
    }
}

TEST_F(Report, TheStateBeforeIsTheEarlierCaptureWhereThereIsOne) {
    Treatment treatment = Treatment::open(folder());
    auto dirty = flat_surface(90, 60);
    for (Rgb& c : dirty->diffuse.pixels()) c *= Rgb(0.5f, 0.4f, 0.2f);
    write_painting(dir_ / "dirty.exr", *dirty);
    const Canvas canvas = treatment.read_canvas();
    const Rgb clean = surface_in_state(treatment, canvas, TreatmentStage::before).diffuse(5, 5);
    treatment.keep_earlier(dir_ / "dirty.exr", kAuthorToEscape);
    treatment = Treatment::open(folder());
    EXPECT_TRUE(treatment.has_earlier());
    EXPECT_NEAR(surface_in_state(treatment, canvas, TreatmentStage::before).diffuse(5, 5).b, 0.2f * clean.b,
                1e-3);
    EXPECT_EQ(surface_in_state(treatment, canvas, TreatmentStage::cleaned).diffuse(5, 5), clean);
    EXPECT_TRUE(treatment.check().empty());
    write_treatment_report(treatment, dir_ / "report.html", "");
    EXPECT_THAT(read_text_file(dir_ / "report.html"), HasSubstr("cleaned, raking from above"));
    // Of another size, or changed behind the log's back.
    write_painting(dir_ / "small.exr", *flat_surface(80, 60));
    EXPECT_THAT([&] { treatment.keep_earlier(dir_ / "small.exr", kAuthorToEscape); },
                ThrowsMessage<Error>(HasSubstr("--align-to")));
    write_text_file(folder() / "earlier.exr", "edited");
    EXPECT_EQ(treatment.check().size(), 1u);
}

// A pixel that counts as a millimetre measures nothing: no figure, scale or bar pretends to it.
TEST_F(Report, OfAPaintingWithoutAScaleStatesNoMillimetres) {
    auto surface = flat_surface(90, 60);
    surface->scale_known = false;
    for (int y = 20; y < 40; ++y)
        for (int x = 30; x < 60; ++x) surface->height_mm(x, y) = -0.3f;
    write_painting(dir_ / "u.exr", *surface);
    Treatment treatment = Treatment::begin(dir_ / "u.treatment", dir_ / "u.exr", kAuthorToEscape);
    Mask loss(90, 60);
    for (int y = 20; y < 40; ++y)
        for (int x = 30; x < 60; ++x) loss(x, y) = 1;
    draw_step(treatment, {DamageClass::loss_to_ground, loss, {}}, kAuthorToEscape);
    Canvas canvas = treatment.read_canvas();
    const nlohmann::json filled =
        fill_step(treatment, canvas, {loss}, {FillTexture::smooth, Rgb(0.8f)}, kAuthorToEscape);
    EXPECT_GT(filled["deepest_px"].get<double>(), 0);
    EXPECT_EQ(filled.dump().find("_mm"), std::string::npos) << filled;
    const nlohmann::json gloss = {{"specular", 0.031},
                                  {"roughness", 0.22},
                                  {"area_px", 600},
                                  {"parts", 6},
                                  {"boxes_px", {{30, 20, 60, 40}, {1, 2, 3, 4}}},
                                  {"of_paints", {{"specular", 0.04}, {"roughness", 0.15}}},
                                  {"remedy", "matting agent"}};
    treatment.record({.action = "test", .results = {{"layer", "fill 1"}, {"gloss", {gloss}}}},
                     kAuthorToEscape);
    write_treatment_report(treatment, dir_ / "u.html", "tangipaint test");
    const std::string page = read_text_file(dir_ / "u.html");
    const std::string measured = page.substr(0, page.find("6. Log"));
    for (const char* unit : {" mm<", "mm²", "mm³", "cm²"})
        EXPECT_EQ(measured.find(unit), std::string::npos) << unit;
    EXPECT_THAT(measured, AllOf(HasSubstr("the scale is unknown"), HasSubstr("600 px"), HasSubstr("0.031"),
                                HasSubstr("at 30, 20; 1, 2 and 4 more"), HasSubstr("by matting agent")));
    if (std::system("command -v pdftotext >/dev/null 2>&1") == 0)
        for (const char* file : {"u.mask.colour.pdf", "u.mask.white.pdf", "u.pdf"}) {
            const std::string text = text_of_pdf(dir_ / file, dir_ / "mask.txt");
            EXPECT_THAT(text, HasSubstr("Not at scale")) << file;
            EXPECT_THAT(text, testing::Not(HasSubstr("on the painting\n"))) << file;
        }
}

// A plan larger than the page says at which scale it is.
TEST(ReportPdf, PlansAreReducedToAScaleThatIsRound) {
    if (std::system("command -v pdftotext >/dev/null 2>&1") != 0)
        GTEST_SKIP() << "pdftotext (poppler-utils) is not installed";
    TestDir dir;
    ReportPlan plan;
    plan.outlines = {{{10, 10}, {500, 10}, {500, 700}}};
    plan.width_mm = 600, plan.height_mm = 800;
    plan.caption = "mask";
    write_pdf(dir / "a.pdf", ReportDocument{"title", {plan}});
    EXPECT_THAT(text_of_pdf(dir / "a.pdf", dir / "a.txt"),
                AllOf(HasSubstr("Scale 1:5;"), HasSubstr("100 mm on the painting")));
}

// No line of a long table is lost at the end of a page, or of a row longer than a page.
TEST(ReportPdf, LongTablesGoOnOnTheNextPage) {
    if (std::system("command -v pdftotext >/dev/null 2>&1") != 0)
        GTEST_SKIP() << "pdftotext (poppler-utils) is not installed";
    TestDir dir;
    ReportTable table{{"head"}, {}, {1}};
    for (int i = 0; i < 150; ++i) table.rows.push_back({fmt::format("row <{}>", i)});
    std::string longest;
    for (int i = 0; i < 3000; ++i) longest += fmt::format("word{} ", i);
    table.rows.push_back({longest});
    write_pdf(dir / "a.pdf", ReportDocument{"title", {ReportHeading{"Log"}, table}});
    const std::string text = text_of_pdf(dir / "a.pdf", dir / "a.txt");
    for (int i = 0; i < 150; ++i) EXPECT_THAT(text, HasSubstr(fmt::format("row <{}>", i)));
    EXPECT_EQ(count(text, "word"), 3000);
    EXPECT_EQ(count(text, "head"), count(text, "\f"));
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
    const nlohmann::json page = web_annotations(treatment, "my report");
    ASSERT_EQ(page.at("items").size(), 1u);
    EXPECT_EQ(page["generator"]["name"], program_name());
    const nlohmann::json& item = page["items"][0];
    EXPECT_EQ(item["type"], "Annotation");
    EXPECT_EQ(item["target"]["source"], "my%20report.picture.jpg");
    EXPECT_EQ(item["target"]["selector"]["type"], "SvgSelector");
    EXPECT_EQ(item["body"][0]["value"], "loss to ground");
    EXPECT_THAT(item["target"]["selector"]["value"].get<std::string>(),
                AllOf(HasSubstr("<svg xmlns"), HasSubstr("30.0"), HasSubstr("60.0")));

    const nlohmann::json manifest = iiif_manifest(treatment, "my report");
    EXPECT_EQ(manifest["@context"], "http://iiif.io/api/presentation/3/context.json");
    EXPECT_TRUE(manifest["label"]["en"].is_array());
    ASSERT_EQ(manifest["items"].size(), 1u);
    const nlohmann::json& canvas = manifest["items"][0];
    EXPECT_EQ(canvas["width"], 90);
    EXPECT_EQ(canvas["items"][0]["items"][0]["body"]["id"], "my%20report.picture.jpg");
    EXPECT_EQ(canvas["items"][0]["items"][0]["target"], canvas["id"]);
    EXPECT_EQ(canvas["annotations"][0]["type"], "AnnotationPage");
    EXPECT_EQ(canvas["annotations"][0]["items"][0]["target"]["source"]["id"], canvas["id"]);
    EXPECT_EQ(manifest["metadata"][0]["value"]["none"][0], "p.exr");
    EXPECT_EQ(manifest["metadata"][3]["value"]["none"][0], program_name());

    // Published, all are addresses (IIIF Presentation 3.0, 3.2: identifiers are HTTP(S) URIs).
    const std::string there = "https://museum.example/42/";
    const nlohmann::json published = iiif_manifest(treatment, "r", there);
    EXPECT_EQ(published["id"], there + "r.manifest.json");
    const nlohmann::json& shown = published["items"][0];
    EXPECT_EQ(shown["items"][0]["items"][0]["body"]["id"], there + "r.picture.jpg");
    EXPECT_EQ(published.dump().find("urn:"), std::string::npos);
    EXPECT_EQ(web_annotations(treatment, "r", there)["items"][0]["target"]["source"],
              there + "r.picture.jpg");
}

TEST_F(Report, PicturesShowDamageAndAdditions) {
    const Treatment treatment = Treatment::open(folder());
    const Canvas canvas = treatment.read_canvas();
    EXPECT_TRUE(canvas.dried().at(0).levels);  // through the file
    const Image<Rgb> damage = damage_picture(treatment, canvas.dry());
    EXPECT_GT(damage.height(), 60);                        // the legend is below
    EXPECT_GT(damage(45, 30).r - damage(45, 30).b, 0.3f);  // orange
    EXPECT_NEAR(damage(5, 5).r, damage(5, 5).b, 1e-6);
    const Image<Rgb> additions = additions_picture(canvas, treatment.layers(), mapped_damage(treatment));
    EXPECT_GT(additions(45, 30).g - additions(45, 30).r, 0.2f);  // green
    const Image<Rgb> beside = additions_picture(canvas, treatment.layers(), Mask(90, 60));
    EXPECT_GT(beside(45, 30).r - beside(45, 30).g, 0.2f);  // red: no damage is mapped there
    EXPECT_NEAR(additions(5, 5).g, additions(5, 5).r, 1e-6);
    const Image<Rgb> look = look_of(canvas.dry(), distant_light({0, 0, 1}), 45);
    EXPECT_EQ(look.width(), 45);
}

}  // namespace
}  // namespace tangi
