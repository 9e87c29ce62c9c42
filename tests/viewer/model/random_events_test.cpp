// random_events_test.cpp: anything at all in any order, on a disk that fills up and a program that is
// killed: every journal replays to what was saved, bit for bit.
//
// Short here. TP_RANDOM_S=3600 lets it go on for an hour, TP_RANDOM_SEED=7 is another hand.
#include <gmock/gmock.h>

#include "retouch/treatment/confining_mask.h"
#include "tests/support/viewer/painter_support.h"

namespace tangi {
namespace {

double number_from(const char* variable, double otherwise) {
    const char* text = std::getenv(variable);
    return text ? std::atof(text) : otherwise;
}

class RandomSitting : public testing::Test {
protected:
    static constexpr int kWidth = 64, kHeight = 48;

    void open(const fs::path& file) {
        painter_.reset();
        Painter::Setup setup{read_canvas(file), artist_acrylics(), file, false};
        painter_ = std::make_unique<Painter>(std::move(setup), [] {});
        painter_->start(std::make_shared<TexelTiles>(painter_->surface(), painter_->range()));
        layers_ = {"none"};
    }
    void settle() {
        painter_->wait();
        for (const std::string& layer : painter_->fetch().state.layers) layers_.push_back(layer);
    }
    PaintParts paint() {
        static const std::vector<std::string> names = {"Titanium White", "Ultramarine Blue", "Bone Black"};
        const auto any = [&] { return names[static_cast<std::size_t>(random_.below(3))]; };
        if (random_.below(20) == 0) return {{"no such paint", 1}};
        if (random_.below(4) == 0) return {};
        PaintParts parts = {{any(), random_.uniform(0.1, 2)}};
        if (const std::string second = any(); second != parts.front().first) parts.emplace_back(second, 1);
        return parts;
    }
    StrokeEvent some_stroke() {
        StrokeEvent event;
        event.brush = random_.below(3) ? flat_of(random_.uniform(2, 6)) : even_brush();
        event.brush.erases = random_.below(8) == 0;
        event.paint = paint();
        event.on = random_.below(4) ? Place::painting : Place::palette;
        const int start = random_.below(4);
        event.start = start < 2 ? BrushStart::clean : start == 2 ? BrushStart::dirty : BrushStart::same;
        event.seed = static_cast<std::uint64_t>(random_.below(1 << 30));
        time_s_ = 0;
        return event;
    }
    PointEvent some_point() {
        at_ += glm::dvec2(random_.uniform(-3, 3), random_.uniform(-3, 3));
        at_ = glm::clamp(at_, glm::dvec2(-10), glm::dvec2(10));
        time_s_ += 0.01;
        return {{.time_s = time_s_, .x_mm = at_.x, .y_mm = at_.y, .pressure = random_.uniform()}};
    }
    // Far more often than not what a hand does, in any order all the same.
    void act() {
        PileEvent pile;
        PaletteEvent palette;
        switch (random_.below(40)) {
            case 0:
            case 1:
            case 2:
                return painter_->send(UndoEvent{});
            case 3:
            case 4:
                return painter_->send(RedoEvent{});
            case 5:
                return painter_->send(
                    DryEvent{fmt::format("l{}", random_.below(5)), random_.uniform(0.2, 1)});
            case 6:
                return painter_->send(LiftEvent{
                    layers_[static_cast<std::size_t>(random_.below(static_cast<int>(layers_.size())))]});
            case 7:
                pile.paint = paint();
                pile.size_mm = 5;
                pile.on = random_.below(2) ? Place::painting : Place::palette;
                return painter_->send(pile);
            case 8:
                pile.paint = paint();
                pile.size_mm = 4;
                return painter_->squeeze(pile);
            case 9:
                palette.paints = {"Bone Black", "Titanium White"};
                return painter_->send(palette);
            case 10:
                if (random_.below(3) == 0) painter_->save();
                return;
            case 11:
                painter_->confine({}, {});
                return;
            case 12:
                painter_->look([](const Surface&, const Canvas&) {}).wait();
                return;
            case 13:
                return painter_->probe(3, 3);
            case 14:
                return settle();
            case 15:
            case 16:
            case 17:
                return painter_->send(EndEvent{});
            case 18:
            case 19:
            case 20:
            case 21:
                return painter_->send(some_stroke());
            default:
                return painter_->send(some_point());
        }
    }

    // Brushes stop at a disc, softly, or nowhere.
    void confine_somewhere() {
        if (random_.below(3) == 0) return painter_->confine({}, {});
        const double x0 = random_.uniform(0, kWidth), radius = random_.uniform(8, 24);
        Mask mask(kWidth, kHeight);
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x)
                mask(x, y) = static_cast<float>(
                    std::clamp((radius - std::hypot(x - x0, y - kHeight / 2.0)) / 3, 0.0, 1.0));
        ConfiningMask stops = confining_mask(folder_.path(), mask);
        painter_->confine({stops.mask, stops.name, std::move(stops.png)}, {});
    }

    TestDir folder_;
    Random random_{static_cast<std::uint64_t>(number_from("TP_RANDOM_SEED", 1))};
    double seconds_ = number_from("TP_RANDOM_S", 4);
    std::unique_ptr<Painter> painter_;
    std::vector<std::string> layers_;
    glm::dvec2 at_{0};
    double time_s_ = 0;
};

// As a kill at this moment leaves it.
void copy_with_times(const fs::path& from, const fs::path& to) {
    fs::remove_all(to);
    fs::create_directory(to);
    for (const auto& entry : fs::directory_iterator(from)) {
        if (!entry.is_regular_file()) continue;
        const fs::path copy = to / entry.path().filename();
        fs::copy_file(entry.path(), copy);
        fs::last_write_time(copy, fs::last_write_time(entry.path()));
    }
}

TEST_F(RandomSitting, EveryJournalReplaysToWhatWasSaved) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds_);
    int rounds = 0, recovered = 0;
    for (; rounds < 2 || std::chrono::steady_clock::now() < end; ++rounds) {
        SCOPED_TRACE(rounds);
        const fs::path here = folder_ / fmt::format("{}", rounds), killed = folder_ / "killed";
        fs::create_directory(here);
        fs::path file = here / "a.exr";
        write_painting(file, *flat_surface(kWidth, kHeight, 0.5));
        open(file);
        std::optional<FullDisk> full;
        for (int i = 0; i < 400; ++i) {
            act();
            if (random_.below(60) == 0) {
                settle();
                const fs::path unsaved = recovery_files(file).unsaved;
                full.reset();
                if (random_.below(2))
                    full.emplace((fs::exists(unsaved) ? fs::file_size(unsaved) : 0) +
                                 static_cast<std::size_t>(random_.below(600)));
            }
            if (i == 200) {  // what waits for room in memory goes with the program
                full.reset();
                painter_->send(PaletteEvent{});
                settle();
                copy_with_times(here, killed);
            }
            if (i == 300 && random_.below(2)) {
                full.reset();
                painter_->save_as(file = here / "b.exr");
            }
        }
        full.reset();
        painter_->save();
        settle();
        ASSERT_TRUE(recorded_as_saved(file));
        ASSERT_FALSE(left_over(recovery_files(file)));

        // What was killed goes on.
        file = killed / "a.exr";
        auto left = left_over(recovery_files(file));
        open(file);
        if (left) {
            ++recovered;
            EXPECT_EQ(left->lines_lost, 0);
            painter_->recover(std::move(*left));
        }
        for (int i = 0; i < 40; ++i) act();
        painter_->save();
        settle();
        ASSERT_TRUE(recorded_as_saved(file));
        painter_.reset();
        fs::remove_all(here);
    }
    EXPECT_GT(recovered, 0);
}

// Saved as a step of a log: with each, its own journal makes of the painting before, and of the palette and
// the brush that its file had, what was dried then.
TEST_F(RandomSitting, EveryJournalOfATreatmentReplaysToItsLayer) {
    const fs::path file = folder_ / "painting.exr", before = folder_ / "before.exr";
    write_painting(file, *flat_surface(kWidth, kHeight, 0.5));
    fs::copy(file, before);
    open(file);
    int kept = 0, with_strokes = 0, confined = 0;
    std::string wrong;
    const auto repeat = [&](const fs::path& journal, const Canvas& canvas) {
        Session again(read_canvas(before), artist_acrylics());
        again.masks_from(masks_beside(journal, kWidth, kHeight));
        read_tools(before, again);
        const Journal strokes = read_journal(journal);
        require_in_order(strokes);
        replay(again, strokes);
        with_strokes += strokes.entries.size() > 10;
        confined += std::ranges::any_of(strokes.entries, [](const auto& entry) {
            return std::holds_alternative<ConfineEvent>(entry.event);
        });
        const Session painted(canvas, artist_acrylics());
        if (const auto same = same_paint(again, painted); !same) wrong = same.message();
    };
    painter_->keep_by([&](Canvas& canvas, const Painter::ToKeep& recovery) -> Painter::Kept {
        if (recovery.journal.empty()) return {"nothing to keep", false};
        const fs::path copy = folder_ / fmt::format("retouch_{}.jsonl", ++kept);
        write_bytes(copy, recovery.journal);
        fs::remove(recovery.unsaved);
        for (const auto& [name, png] : recovery.masks)
            EXPECT_EQ(bytes_of(folder_ / confining_mask_file(name)), png);
        try {
            repeat(copy, canvas);
        } catch (const Error& error) {
            wrong = error.what();
        }
        if (!canvas.wet().empty()) dry(canvas, fmt::format("retouch {}", kept));
        {
            AtomicFile out(file);
            write_canvas(out, canvas, {}, recovery.tools);
        }
        fs::copy_file(file, before, fs::copy_options::overwrite_existing);
        return {"kept"};
    });
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds_);
    while (kept < 5 || std::chrono::steady_clock::now() < end) {
        for (int i = 0; i < 150; ++i) {
            act();
            if (random_.below(40) == 0) confine_somewhere();
        }
        painter_->save();
        settle();
        ASSERT_EQ(wrong, "") << "retouch_" << kept;
    }
    EXPECT_GT(with_strokes, 2);
    EXPECT_GT(confined, 0);
}

}  // namespace
}  // namespace tangi
