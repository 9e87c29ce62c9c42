// treatment_strokes_test.cpp: journals that a treatment's log vouches for can be painted again, or it
// is told.
#include "retouch/treatment/treatment_strokes.h"

#include <gmock/gmock.h>

#include "paint/session/session.h"
#include "retouch/treatment/treatment_steps.h"
#include "tests/support/retouch/treatment_folder.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(TreatmentFolder, StrokesThatCannotBeRepeatedAreTold) {
    const std::string header = "{\"format\": \"tangipaint strokes\", \"version\": 1}\n",
                      stroke = "{\"event\": \"stroke\"}\n", undo = "{\"event\": \"undo\"}\n",
                      point = "{\"event\": \"point\", \"x\": 1, \"y\": 1}\n", end = "{\"event\": \"end\"}\n";
    Treatment treatment = begin();
    const auto keep = [&](const std::string& name, const std::string& text) {
        treatment.record({.action = "retouch", .files = {{"strokes/" + name, header + text}}}, kAuthor);
    };
    keep("whole.jsonl", stroke + point + end + undo);
    EXPECT_THAT(strokes_that_cannot_be_repeated(treatment), IsEmpty());
    keep("torn.jsonl", stroke + "{\"event\": \"po" + stroke + point + end);
    keep("undone.jsonl", stroke + point + undo + point + end);
    EXPECT_THAT(treatment.check(), IsEmpty()) << "they are as they were logged";
    EXPECT_THAT(strokes_that_cannot_be_repeated(treatment),
                ElementsAre(AllOf(HasSubstr("strokes/torn.jsonl:3"), HasSubstr("not JSON")),
                            AllOf(HasSubstr("strokes/undone.jsonl:5"), HasSubstr("'undo'"))));
}

// Kept with their strokes, but of others: `treatment check` says which layer they do not make.
TEST_F(TreatmentFolder, StrokesThatMakeAnotherLayerAreTold) {
    Treatment treatment = begin();
    const ConfiningMask mask = confining_mask(folder(), Mask(100, 70, 0.5f));
    for (const bool others : {false, true}) {
        Journal journal;
        StrokeEvent stroke;
        stroke.brush = even_brush();
        stroke.paint = {{"Titanium White", 1}};
        journal.entries = {{2, stroke}};
        for (int i = 0; i <= 10; ++i)
            journal.entries.push_back({3, PointEvent{{.time_s = 0.01 * i, .x_mm = i - 5.0}}});
        journal.entries.push_back({4, EndEvent{}});
        Session session(treatment.read_canvas(), artist_acrylics());
        TreatmentStep step{.action = "retouch"};
        step.strokes = strokes_within(mask, journal, session);
        session.canvas().confine(mask.mask);
        const std::vector<Journal::Entry> once = journal.entries;
        if (others) journal.entries.insert(journal.entries.end(), once.begin(), once.end());
        replay(session, journal);
        Canvas canvas = session.canvas();
        canvas.confine({});
        retouch_step(treatment, canvas, {{Mask(100, 70, 1.0f)}, std::move(step), "test"}, kAuthor);
    }
    const StrokesRepeated repeated = repeat_strokes(treatment, treatment.read_canvas());
    EXPECT_EQ(repeated.painted_again, 1);
    EXPECT_THAT(repeated.faults,
                ElementsAre(AllOf(HasSubstr("strokes/retouch_2.jsonl"), HasSubstr("'retouch 2'"))));
    EXPECT_THAT(treatment.check(), IsEmpty()) << "they are as they were logged";
    EXPECT_THAT(strokes_that_cannot_be_repeated(treatment), IsEmpty()) << "nor are masks taken for journals";
    write_bytes(folder() / confining_mask_file(mask.name), "another");
    EXPECT_THAT(error_of([&] { repeat_strokes(treatment, treatment.read_canvas()); }),
                HasSubstr("is not the mask that brushes stopped at"));
}

}  // namespace
}  // namespace tangi
