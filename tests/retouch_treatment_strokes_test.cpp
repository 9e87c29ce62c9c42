// retouch_treatment_strokes_test.cpp: journals that a treatment's log vouches for can be painted again, or it
// is told.
#include "paint/retouch/treatment_strokes.h"

#include <gmock/gmock.h>

#include "tests/treatment_folder.h"

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

}  // namespace
}  // namespace tangi
