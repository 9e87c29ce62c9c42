// annotation_list_test.cpp: what is done to annotations can be undone, is kept on the disk before it is
// saved, and saved where `export --annotations` takes it from.
#include "viewer/annotations/annotation_list.h"

#include <gmock/gmock.h>

#include "tests/support/test_support.h"
#include "viewer/annotations/annotation_document.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using Drawn = AnnotationKind;

const AnnotatedPicture kListPicture{"urn:tangipaint:0", 200, 100};

AnnotationShape point_at(double x, double y) { return {Drawn::point, {{{x, y}}}}; }

std::vector<std::string> texts_of(const Annotations& annotations) {
    std::vector<std::string> texts;
    for (const auto& one : annotations) texts.push_back(one->text);
    return texts;
}

TEST(AnnotationLists, UndoWhatWasDoneInSteps) {
    AnnotationList list({}, kListPicture);
    EXPECT_FALSE(list.unsaved() || list.can_undo() || list.can_redo());
    const std::string a = list.add(point_at(1, 2), "azimuth=20");
    for (const char* typed : {"c", "cr", "crack"}) list.set_text(a, typed, *typed && typed[1]);
    EXPECT_EQ(list.now().front()->text, "crack");
    EXPECT_EQ(list.now().front()->view, "azimuth=20");
    const std::string b = list.add(point_at(5, 6), "");
    for (int i = 0; i < 4; ++i) list.reshape(b, point_at(10 + i, 6), i > 0);
    list.set_text(a, "crack!", true);  // another thing in between: a step of its own
    list.remove(a);
    EXPECT_EQ(list.now().size(), 1u);
    list.undo();
    EXPECT_THAT(texts_of(list.now()), ElementsAre("crack!", ""));
    list.undo();
    EXPECT_EQ(list.now()[0]->text, "crack");
    list.undo();
    EXPECT_EQ(list.now()[1]->shape, point_at(5, 6)) << "the whole movement";
    list.redo();
    EXPECT_EQ(list.now()[1]->shape, point_at(13, 6));
    list.undo();
    list.undo();
    list.undo();
    EXPECT_THAT(texts_of(list.now()), ElementsAre("")) << "all that was typed";
    list.undo();
    EXPECT_TRUE(list.now().empty() && !list.can_undo() && !list.unsaved());
    list.undo();
    list.redo();
    list.set_view(list.now()[0]->id, "azimuth=30");
    EXPECT_FALSE(list.can_redo()) << "another way was taken";
    list.set_text("urn:nobody", "x", false);
    list.remove("urn:nobody");
    EXPECT_EQ(list.now()[0]->view, "azimuth=30");
}

class AnnotationDocuments : public testing::Test {
protected:
    AnnotationDocument open(bool only_looks = false) { return {painting_, kListPicture, only_looks}; }
    // With one of this text, not saved.
    AnnotationDocument annotated(const std::string& text) {
        AnnotationDocument document = open();
        document.list().set_text(document.list().add(point_at(1, 2), "azimuth=20"), text, false);
        document.keep();
        return document;
    }
    std::vector<std::string> texts(bool only_looks = false) {
        return texts_of(open(only_looks).list().now());
    }

    TestDir folder_;
    fs::path painting_ = folder_ / "a.exr";
};

TEST_F(AnnotationDocuments, AreSavedBesideThePainting) {
    AnnotationDocument document = annotated("loss");
    EXPECT_THAT(names_in(folder_.path()), ElementsAre("a.annotations.unsaved.json"));
    document.save();
    EXPECT_THAT(names_in(folder_.path()), ElementsAre("a.annotations.json"));
    EXPECT_FALSE(document.list().unsaved());
    EXPECT_THAT(texts(), ElementsAre("loss"));
    document.list().undo();
    EXPECT_TRUE(document.list().unsaved()) << "undone after saving";
    document.keep();
    document.list().redo();
    document.keep();
    EXPECT_THAT(names_in(folder_.path()), ElementsAre("a.annotations.json")) << "as it was saved";
    EXPECT_THAT(document.said(), testing::IsEmpty());
}

TEST_F(AnnotationDocuments, ThatWereNotSavedAreThereAgain) {
    annotated("saved").save();
    {
        AnnotationDocument document = open();
        document.list().set_text(document.list().now()[0]->id, "not saved", false);
        document.keep();
    }
    EXPECT_THAT(texts(true), ElementsAre("saved")) << "another window does not take them";
    AnnotationDocument again = open();
    EXPECT_THAT(texts_of(again.list().now()), ElementsAre("not saved"));
    EXPECT_THAT(again.said(), ElementsAre(HasSubstr("not saved are here again")));
    again.list().undo();
    EXPECT_THAT(texts_of(again.list().now()), ElementsAre("saved"));
    again.keep();
    EXPECT_THAT(names_in(folder_.path()), ElementsAre("a.annotations.json"));
    // Killed after saving, before the other file was removed.
    fs::copy(folder_ / "a.annotations.json", folder_ / "a.annotations.unsaved.json");
    EXPECT_FALSE(open().list().unsaved());
    EXPECT_THAT(names_in(folder_.path()), ElementsAre("a.annotations.json"));
}

TEST_F(AnnotationDocuments, KeepWhatOthersWroteAndWhatCannotBeRead) {
    AnnotationDocument document = annotated("mine");
    document.save();
    write_bytes(folder_ / "a.annotations.json", "{\"items\": []}");
    document.list().add(point_at(5, 6), "");
    document.save();
    EXPECT_THAT(document.said(), ElementsAre(HasSubstr("changed by another program, and is kept as "
                                                       "a.annotations.other.json")));
    EXPECT_EQ(bytes_of(folder_ / "a.annotations.other.json"), "{\"items\": []}");
    EXPECT_EQ(texts().size(), 2u);

    write_bytes(folder_ / "a.annotations.json", "{");
    write_bytes(folder_ / "a.annotations.unsaved.json", "nothing");
    AnnotationDocument damaged = open();
    EXPECT_THAT(damaged.said(),
                ElementsAre(HasSubstr("a.annotations.json"), HasSubstr("a.annotations.unsaved.json"),
                            HasSubstr("a.annotations.unread.json")));
    EXPECT_EQ(bytes_of(folder_ / "a.annotations.unread.json"), "nothing");
    damaged.list().add(point_at(5, 6), "");
    damaged.save();
    EXPECT_EQ(bytes_of(folder_ / "a.annotations.unread-2.json"), "{");
    EXPECT_EQ(texts().size(), 1u);
}

TEST_F(AnnotationDocuments, GoWithAPaintingThatIsSavedUnderAnotherName) {
    annotated("of b").save();
    fs::rename(folder_ / "a.annotations.json", folder_ / "b.annotations.json");
    AnnotationDocument document = annotated("mine");
    document.save_beside(folder_ / "b.exr");
    EXPECT_THAT(names_in(folder_.path()), ElementsAre("b.annotations.json", "b.annotations.other.json"));
    EXPECT_FALSE(document.list().unsaved());
    painting_ = folder_ / "b.exr";
    EXPECT_THAT(texts(), ElementsAre("mine"));
    // One that has none leaves none there that are not its own.
    AnnotationDocument none(folder_ / "c.exr", kListPicture, false);
    none.save_beside(painting_);
    EXPECT_TRUE(texts().empty());
}

TEST_F(AnnotationDocuments, LoadOthersAsAWholeOrNotAtAll) {
    AnnotationDocument document = annotated("mine");
    const std::string id = document.list().now()[0]->id;
    nlohmann::json other = new_annotation(point_at(300, 6), "", kListPicture),
                   newer = document.list().now()[0]->json;
    newer["bodyValue"] = "newer";
    write_bytes(folder_ / "more.json", text_of_page({newer, other}));
    const auto [count, beyond] = document.load(folder_ / "more.json");
    EXPECT_EQ(count, 2u);
    EXPECT_EQ(beyond, 1u) << "right of the painting";
    EXPECT_THAT(texts_of(document.list().now()), ElementsAre("newer", ""));
    EXPECT_EQ(document.list().now()[0]->id, id);
    document.list().undo();
    EXPECT_THAT(texts_of(document.list().now()), ElementsAre("mine")) << "one step";
    other["target"]["selector"] = {{"type", "SvgSelector"}, {"value", "<svg><path d='MA1 2 3'/></svg>"}};
    write_bytes(folder_ / "bad.json", text_of_page({newer, other}));
    EXPECT_THAT(error_of([&] { document.load(folder_ / "bad.json"); }), HasSubstr("bad.json: item 2 ("));
    EXPECT_THAT(error_of([&] { document.load(folder_ / "nowhere.json"); }), HasSubstr("nowhere.json"));
    EXPECT_THAT(texts_of(document.list().now()), ElementsAre("mine"));
    document.write_to(folder_ / "copy.json");
    EXPECT_EQ(read_annotations((folder_ / "copy.json").string(), ""), json_of(document.list().now()));
}

TEST_F(AnnotationDocuments, ThatCannotBeWrittenStayUnsaved) {
    AnnotationDocument document(folder_ / "gone" / "a.exr", kListPicture, false);
    document.list().add(point_at(1, 2), "");
    EXPECT_THAT(error_of([&] { document.keep(); }), HasSubstr("a.annotations.unsaved.json"));
    EXPECT_THAT(error_of([&] { document.save(); }), HasSubstr("a.annotations.json"));
    EXPECT_TRUE(document.list().unsaved());
    fs::create_directory(folder_ / "gone");
    document.save();
    EXPECT_FALSE(document.list().unsaved());
}

}  // namespace
}  // namespace tangi
