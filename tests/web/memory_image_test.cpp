// memory_image_test.cpp: a work of the web application opens with the engine's memory as it was kept.
#include "paint/canvas/canvas_hash.h"
#include "surface/painting_file/painting_file.h"
#include "tests/web/tablet.h"
#include "web/engine/ground.h"

namespace tangi {
namespace {

using nlohmann::json;

class WebMemoryImage : public WebApplication {};

// A work opens with the engine's memory as it was kept, and what was painted after that: paint, board, undo.
// Where the image is not whole, all is painted again.
TEST_F(WebMemoryImage, OpensWithTheMemoryThatTheEngineHad) {
    begin();
    tablet_->await(
        "tangipaint.open.work.event({event: 'palette', paints: ['Bone Black', 'Titanium White']})");
    paint_three_strokes();
    const auto keeps = [&](const char* id = "tangipaint.open.work.record.id") {
        return tablet_->await(fmt::format(
            "tangipaint.connection.ask('keep', {{work: {}, next: tangipaint.open.work.next, worth: 0}})",
            id));
    };
    EXPECT_EQ(keeps("'another'"), false);
    EXPECT_EQ(keeps(), true);
    tablet_->pen(straight({260, 300}, {540, 300}));
    ASSERT_TRUE(tablet_->is_settled());
    const json hashes = tablet_->hashes();
    const auto board = [&] { return tablet_->await("tangipaint.open.board.canvas.toDataURL()"); };
    const json palette = board();
    const auto opens_again = [&] {
        tablet_->browser().call("Page.reload");
        ASSERT_TRUE(tablet_->is_drawn()) << tablet_->browser().errors;
        EXPECT_EQ(tablet_->hashes(), hashes);
        EXPECT_EQ(board(), palette);
    };
    opens_again();
    EXPECT_EQ(tablet_->await("tangipaint.open.again"), 1) << "the last stroke alone";
    EXPECT_EQ(keeps(), true);
    opens_again();
    EXPECT_EQ(tablet_->await("tangipaint.open.again"), 0);
    for (int i = 0; i < 4; ++i) {
        ASSERT_TRUE(tablet_->browser().becomes_true("!document.getElementById('undo').disabled"));
        tablet_->await("document.getElementById('undo').click()");
        ASSERT_TRUE(tablet_->is_settled());
    }
    const auto ground = std::make_shared<const Surface>(make_ground(kSmall));
    EXPECT_EQ(tablet_->hashes()["canvas"], hash_of(Canvas(ground), hash_of(*ground))) << "all is undone";
    for (int i = 0; i < 4; ++i) {
        ASSERT_TRUE(tablet_->browser().becomes_true("!document.getElementById('redo').disabled"));
        tablet_->await("document.getElementById('redo').click()");
        ASSERT_TRUE(tablet_->is_settled());
    }
    const auto images = [&](const std::string& then) {
        return tablet_->await(
            "(async () => { const folder = await navigator.storage.getDirectory(), found = []; for await "
            "(const [name, file] of folder.entries()) { found.push(name); " +
            then + " } return found.length; })()");
    };
    EXPECT_EQ(keeps(), true);
    EXPECT_EQ(images("const w = await file.createWritable({keepExistingData: true}); await "
                     "w.truncate((await file.getFile()).size / 2); await w.close();"),
              1)
        << "one image, of which half is gone";
    opens_again();
    EXPECT_EQ(tablet_->await("tangipaint.open.again"), tablet_->strokes());
    EXPECT_EQ(keeps(), true);
    tablet_->await("document.getElementById('to-gallery').click()");
    ASSERT_TRUE(tablet_->browser().becomes_true("!!document.querySelector('#works [aria-label^=Remove]')"));
    tablet_->await("document.querySelector('#works [aria-label^=Remove]').click()");
    tablet_->await("document.querySelector('#asked .danger').click()");
    ASSERT_TRUE(tablet_->browser().becomes_true("!document.querySelector('#works [aria-label^=Remove]')"));
    EXPECT_EQ(images(""), 0) << "it goes with its work";
    EXPECT_EQ(tablet_->browser().errors, "");
}

}  // namespace
}  // namespace tangi
