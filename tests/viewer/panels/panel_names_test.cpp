// panel_names_test.cpp: no two things in a panel have one name: Dear ImGui tells them apart by it, and
// ends the program where it takes a slider that is dragged for a button. And none of them moves under the
// pointer when something happens that nobody clicked for.
//
// Linked so (--wrap, tests/CMakeLists.txt) that what Dear ImGui adds to a window comes by here.
#include <gmock/gmock.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <set>

#include "paint/brush/brush_settings.h"
#include "tests/support/viewer/viewer_support.h"
#include "viewer/panels/fonts.h"
#include "viewer/panels/panels.h"

namespace {

// Of the frame that is drawn.
struct Names {
    std::map<ImGuiID, std::string> of;
    std::map<ImGuiID, int> times;
    std::set<std::string> twice;
    std::map<ImGuiID, ImVec2> places;  // their upper left corners
} names;

}  // namespace

// As the linker's --wrap names them.
// NOLINTBEGIN(bugprone-reserved-identifier)
extern "C" {
bool __real__ZN5ImGui7ItemAddERK6ImRectjPS1_i(const ImRect&, ImGuiID, const ImRect*, ImGuiItemFlags);
bool __wrap__ZN5ImGui7ItemAddERK6ImRectjPS1_i(const ImRect& box, ImGuiID id, const ImRect* navigated,
                                              ImGuiItemFlags flags) {
    // A field of several lines is a window as well, which is added again as such, in its place.
    const auto before = names.places.find(id);
    const bool again =
        before != names.places.end() && before->second.x == box.Min.x && before->second.y == box.Min.y;
    if (id != 0 && !again && ++names.times[id] == 2) names.twice.insert(names.of[id]);
    if (id != 0) names.places[id] = box.Min;
    return __real__ZN5ImGui7ItemAddERK6ImRectjPS1_i(box, id, navigated, flags);
}
ImGuiID __real__ZN11ImGuiWindow5GetIDEPKcS1_(ImGuiWindow*, const char*, const char*);
ImGuiID __wrap__ZN11ImGuiWindow5GetIDEPKcS1_(ImGuiWindow* window, const char* begin, const char* end) {
    const ImGuiID id = __real__ZN11ImGuiWindow5GetIDEPKcS1_(window, begin, end);
    names.of[id] = std::string(window->Name) + ": " + (end ? std::string(begin, end) : begin);
    if (window->DC.StateStorage) window->DC.StateStorage->SetInt(id, 1);  // what folds is unfolded
    return id;
}
}
// NOLINTEND(bugprone-reserved-identifier)

namespace tangi {
namespace {

// So many of each kind, of which the last is chosen.
void annotate(WindowState& state, int count) {
    AnnotationList list({}, {"", 400, 300});
    for (int i = 0; i < count; ++i) {
        const auto kind = static_cast<AnnotationKind>(i % kAnnotationKinds);
        std::vector<glm::dvec2> ring = {{10.0 * i, 20}};
        if (kind == AnnotationKind::line || kind == AnnotationKind::polygon)
            ring.insert(ring.end(), {{10.0 * i + 9, 20}, {10.0 * i + 9, 30}});
        state.annotations.chosen = list.add({kind, {ring}}, "");
    }
    state.annotations.items = list.now();
}

class PanelNames : public testing::Test {
protected:
    void SetUp() override {
        IMGUI_CHECKVERSION();
        ImGui::CreateContext();
        ImGuiIO& io = ImGui::GetIO();
        io.IniFilename = nullptr;
        io.DisplaySize = {1600, 4000};  // all panels unfolded, without a scroll bar
        const PanelFonts fonts(1);      // texts are as wide as in the window
        state_.painting = {400, 300};
        state_.scale_known = state_.treatment_state.scale_known = true;
        state_.brushes = brush_presets();
        state_.use_brush("flat");
        state_.use_palette(artist_acrylics());
        for (const Pigment& paint : state_.palette.paints) state_.mix[paint.name] = 1;
        state_.paint_colours.assign(state_.palette.paints.size(), Rgb(0.5f));
        state_.help = state_.board.open = state_.new_canvas.open = true;
    }
    void TearDown() override { ImGui::DestroyContext(); }

    // All panels as they are in this state. A tab that is asked for is seen some frames later.
    void draw() {
        for (int i = 0; i < 3; ++i) {
            names = {};
            ImGui::NewFrame();
            panels::column(state_, 3900);
            if (state_.treatment_state.on) panels::treatment_column(state_, 3900);
            panels::measurements(state_);
            panels::board(state_);
            panels::new_canvas(state_);
            panels::help(state_);
            ImGui::Render();
        }
        ASSERT_GT(names.times.size(), 50u);
        EXPECT_THAT(names.twice, testing::IsEmpty());
    }

    WindowState state_;
};

TEST_F(PanelNames, AreSeenTwice) {
    ImGui::NewFrame();
    ImGui::RadioButton("Brush", true);
    float size = 1;
    ImGui::SliderFloat("Brush", &size, 0, 2);
    ImGui::Render();
    EXPECT_THAT(names.twice, testing::ElementsAre(testing::EndsWith("Brush")));
}

TEST_F(PanelNames, OfAPaintingDiffer) {
    draw();
    state_.comparing.loaded = true;
    state_.board.size = {420, 315};
    state_.painter.has_board = true;
    state_.board.texture = 1;
    state_.job = state_.film = Job::State();
    state_.left_over_strokes = 3;
    annotate(state_, 4);
    state_.closing = true;
    state_.lights.resize(4);
    for (const Tool tool : {Tool::tilt, Tool::light, Tool::paint, Tool::ruler, Tool::annotate}) {
        state_.tool = tool;
        draw();
    }
    for (const ViewMode mode : {ViewMode::specular_enhancement, ViewMode::height, ViewMode::curvature}) {
        state_.mode = mode;
        draw();
    }
    for (const CompareWay way : {CompareWay::aside, CompareWay::blink}) {
        state_.comparing.way = way;
        draw();
    }
}

TEST_F(PanelNames, OfATreatmentDiffer) {
    TreatmentState& t = state_.treatment_state;
    t.on = t.usable = true;
    t.edits = 2;
    t.job = Job::State();
    t.suggestion.emplace();
    t.preview.emplace();
    t.match.emplace();
    t.match->recipes.resize(3);
    t.pairs.resize(2);
    t.layers.resize(2);
    t.layers[0].name = "fill-1";
    t.layers[1].name = "retouch-1";
    t.log.resize(4);
    t.faults = {"a", "b"};
    for (std::size_t i = 0; i < kDamageClasses.size(); ++i) {
        t.damage[i].damage = kDamageClasses[i];
        t.damage[i].there = true;
        t.where.insert(kDamageClasses[i]);
    }
    for (const char* tab : {"Damage", "Steps", "Colour", "Record"})
        for (const MaskTool tool : {MaskTool::brush, MaskTool::polygon, MaskTool::wand, MaskTool::area})
            for (const Suggesting what : {Suggesting::loss, Suggesting::craquelure, Suggesting::gloss,
                                          Suggesting::old_fill, Suggesting::abrasion})
                for (const RetouchMode mode :
                     {RetouchMode::mimetic, RetouchMode::tratteggio, RetouchMode::neutral}) {
                    t.forward = tab;
                    t.mask_tool = tool;
                    t.suggesting = what;
                    t.mode = mode;
                    SCOPED_TRACE(tab);
                    draw();
                }
}

// A folder of photographs that has been opened.
class OpenedPhotographs : public PhotoBook {
public:
    const std::vector<Entry>& entries() const override { return entries_; }
    const std::vector<std::string>& warnings() const override { return warnings_; }
    const ColourScale& difference_scale() const override { return scale_; }
    const ColourScale& delta_e_scale() const override { return scale_; }
    HeldPhoto hold(int, const Progress&) const override { return {}; }
    void write_report(const std::filesystem::path&, const std::vector<int>&, const Progress&) const override {
    }

    std::vector<std::string> warnings_;

private:
    std::vector<Entry> entries_{{"0.png", distant_light({0, 0, 1}), true},
                                {"1.png", distant_light({1, 0, 1}), true}};
    ColourScale scale_;
};

class PanelPlaces : public PanelNames {
protected:
    // What is there before and after it happens is where it was.
    template <class Happens>
    void stays_when(const char* what, const Happens& happens) {
        SCOPED_TRACE(what);
        draw();
        const Names before = names;
        happens();
        draw();
        int both = 0;
        for (const auto& [id, place] : before.places) {
            const auto after = names.places.find(id);
            if (after == names.places.end()) continue;
            ++both;
            EXPECT_TRUE(place.x == after->second.x && place.y == after->second.y)
                << names.of[id] << " moves from " << place.x << ", " << place.y << " to " << after->second.x
                << ", " << after->second.y;
        }
        EXPECT_GT(both, 50);
    }
};

TEST_F(PanelPlaces, StayWhenSomethingHappensToThePainting) {
    WindowState& s = state_;
    stays_when("another window has it", [&] { s.painter.elsewhere = true; });
    stays_when("and gives it back", [&] { s.painter.elsewhere = false; });
    stays_when("the scale is not known", [&] { s.scale_known = false; });
    stays_when("the window says something",
               [&] { s.said.assign(5, "a message of some length, which is said"); });
    stays_when("the fit had doubts", [&] { s.doubts.assign(3, "a doubt"); });
    stays_when("a light is near", [&] { s.lights[0].near = true; });
    stays_when("there are no shadows", [&] { s.shadows = false; });
    stays_when("there are more lights", [&] { s.lights.resize(4); });
    stays_when("a canvas cannot be made",
               [&] { s.new_canvas.complaint = "it is there already: choose another name"; });
    stays_when("its preview is there", [&] {
        s.new_canvas.texture = 1;
        s.new_canvas.preview = {300, 130};
    });
    state_.tool = Tool::annotate;
    stays_when("there are annotations", [&] { annotate(s, 9); });
    stays_when("they are not saved", [&] { s.annotations.unsaved = s.annotations.can_undo = true; });
    stays_when("none is chosen", [&] { s.annotations.chosen.clear(); });
    stays_when("another window has them",
               [&] { s.annotations.refused = "a reason, which is longer than a line"; });
    stays_when("head and sensor are followed", [&] { s.follow.head = s.follow.sensor = true; });
}

TEST_F(PanelPlaces, StayWhenPhotographsAreRead) {
    OpenedPhotographs book;
    Comparing& c = state_.comparing;
    c.loaded = c.on = true;
    stays_when("the folder is open", [&] { c.news.book = &book; });
    stays_when("it is warned of", [&] {
        book.warnings_ = {"one", "another warning, which is longer than a line is wide"};
    });
    stays_when("a photograph is measured", [&] {
        auto held = std::make_shared<HeldPhoto>();
        held->whole.pixels = 100;
        c.news.held = held;
    });
    stays_when("nothing was measured in another", [&] { c.news.held = std::make_shared<HeldPhoto>(); });
    stays_when("a region is measured", [&] {
        state_.region = Region{0, 0, 10, 10};
        c.news.part = {0, *state_.region, Likeness{.pixels = 100}};
    });
    stays_when("it blinks", [&] { c.way = CompareWay::blink; });
    stays_when("the painting is shown again", [&] { c.on = false; });
}

// A click on a paint takes the brush into the hand, whose panels come first then: once the pointer has left.
TEST_F(PanelPlaces, StayUnderThePointerThatTakesTheBrush) {
    state_.tool = Tool::tilt;
    draw();
    const auto paint = std::ranges::find_if(
        names.places, [](const auto& item) { return names.of[item.first].ends_with(": paint"); });
    ASSERT_NE(paint, names.places.end());
    const auto [id, place] = *paint;
    ImGui::GetIO().MousePos = {place.x + 5, place.y + 5};
    stays_when("the tool is another", [&] { state_.tool = Tool::paint; });
    ImGui::GetIO().MousePos = {800, 400};
    draw();
    EXPECT_LT(names.places.at(id).y, place.y);
}

TEST_F(PanelPlaces, StayWhenATreatmentGoesOn) {
    TreatmentState& t = state_.treatment_state;
    for (const char* tab : {"Damage", "Steps", "Colour", "Record"}) {
        SCOPED_TRACE(tab);
        t = TreatmentState();
        state_.painter = {};
        t.on = t.usable = true;
        for (std::size_t i = 0; i < kDamageClasses.size(); ++i) t.damage[i].damage = kDamageClasses[i];
        t.forward = tab;
        draw();
        stays_when("damage is mapped", [&] {
            for (DamageRow& row : t.damage) row.there = true, row.logged = {12, 123.45, 12.3};
        });
        stays_when("something is suggested", [&] {
            t.suggestion.emplace();
            t.suggestion->title = "Craquelure";
            t.suggestion->measured =
                "a measure of it that takes more than a line of the panel to be told in words";
            t.suggestion->shown = 3;
        });
        stays_when("with other settings", [&] { t.suggestion->stale = true; });
        for (const MaskTool tool : {MaskTool::wand, MaskTool::area, MaskTool::polygon, MaskTool::brush})
            stays_when("another tool draws", [&] { t.mask_tool = tool; });
        for (const Suggesting what : {Suggesting::craquelure, Suggesting::gloss, Suggesting::flaking})
            stays_when("something else is looked for", [&] { t.suggesting = what; });
        stays_when("the map is corrected", [&] { t.edits = 2; });
        stays_when("something runs", [&] { t.job = Job::State(); });
        stays_when("paint is laid", [&] {
            state_.painter.unsaved = true;
            state_.painter.painted_px = 100;
            state_.painter.outside_px = 5;
        });
        stays_when("one may not paint",
                   [&] { t.no_strokes = "choose the damage that is retouched: Steps, Area"; });
        stays_when("a layer is laid", [&] { t.layers.push_back({"retouch 1", LayerRole::retouch, {}}); });
        stays_when("the mode is another", [&] { t.mode = RetouchMode::tratteggio; });
        stays_when("a retouch is previewed", [&] {
            t.preview.emplace();
            t.preview->lines = "23 lines or dots, 2.00 mm apart, 1.00 mm wide; they fuse from 1.2 m on";
            t.preview->piles.assign(6, "20 %  3 parts Titanium White, 1 part Yellow Ochre");
        });
        stays_when("with other settings", [&] { t.preview->stale = true; });
        stays_when("the fill is as the weave", [&] { t.texture = FillTexture::weave; });
        stays_when("it is not as its log says", [&] {
            t.usable = false;
            t.faults = {"a fault", "another one"};
        });
    }
}

TEST_F(PanelPlaces, AreReachedInASmallWindow) {
    TreatmentState& t = state_.treatment_state;
    t.on = t.usable = true;
    state_.help = state_.board.open = state_.new_canvas.open = false;
    ImGui::GetIO().DisplaySize = {800, 600};
    state_.window_width = 800;
    EXPECT_GE(800 - panels::width(state_) - panels::treatment_width(state_), 400) << "left for the painting";
    const auto small = [&] {
        for (int i = 0; i < 3; ++i) {
            names = {};
            ImGui::NewFrame();
            panels::column(state_, 600);
            panels::treatment_column(state_, 600);
            ImGui::Render();
        }
    };
    const auto is_there = [&](const std::string& name) {
        return std::ranges::any_of(names.of,
                                   [&](const auto& of) { return of.second.ends_with(": " + name); });
    };
    small();
    EXPECT_TRUE(is_there("Damage"));
    EXPECT_FALSE(is_there("dome"));
    EXPECT_EQ(ImGui::FindWindowByName("treatment"), nullptr);
    t.in_front = false;
    small();
    EXPECT_TRUE(is_there("dome"));
    state_.window_width = 1280;
    EXPECT_GT(panels::treatment_width(state_), 0) << "there is room for both";
    // Nothing is wider than its column.
    for (const int wide : {800, 1280})
        for (const bool front : {true, false}) {
            ImGui::GetIO().DisplaySize.x = static_cast<float>(wide);
            state_.window_width = wide;
            t.in_front = front;
            small();
            for (const char* name : {"column", "treatment"}) {
                const ImGuiWindow* column = ImGui::FindWindowByName(name);
                if (!column || !column->Active) continue;
                EXPECT_LE(column->ContentSize.x, column->WorkRect.GetWidth())
                    << name << (front ? ", the treatment" : ", the others") << " at " << wide;
            }
        }
}

}  // namespace
}  // namespace tangi
