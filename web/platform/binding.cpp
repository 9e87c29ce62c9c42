// binding.cpp: what JavaScript calls (web/app/engine.js): one Easel, JSON in and out, pixels as bytes in
// memory.
//
// Each call returns 1, or 0 where it failed; tp_text() is its answer or the error, tp_bytes() its bytes. Both
// are good until the next call.
#include <emscripten.h>

#include <exception>
#include <new>

#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/math/portable_math.h"
#include "web/engine/easel.h"
#include "web/engine/ground.h"
#include "web/engine/painting_bytes.h"

// Bytes of the page's file (web/app/engine.js: Engine.reads()); 0 where it cannot be read.
EM_JS(int, read_file, (double at, char* to, int count), { return Module["readFile"](at, to, count); });

namespace {

using nlohmann::json;
using tangi::Easel;

struct Answer {
    std::string text;
    std::vector<std::uint8_t> bytes;
};

std::optional<Easel>& easel() {
    static std::optional<Easel> one;
    return one;
}
Answer& answer() {
    static Answer one;
    return one;
}

std::optional<tangi::PaintingToSave>& painting_file() {
    static std::optional<tangi::PaintingToSave> one;
    return one;
}

tangi::ByteSource page_file(double size) {
    return {static_cast<std::uint64_t>(size), [](std::uint64_t at, std::span<char> to) {
                if (!read_file(static_cast<double>(at), to.data(), static_cast<int>(to.size())))
                    tangi::fail("the painting file cannot be read: choose it again");
            }};
}

Easel& open_easel() {
    if (!easel()) tangi::fail("no painting is open");
    return *easel();
}

template <class Work>
int guarded(const Work& work) {
    answer() = {};
    try {
        work();
        return 1;
    } catch (const std::bad_alloc&) {
        answer().text = "there is not enough memory for this";
    } catch (const std::exception& error) {
        answer().text = error.what();
    }
    return 0;
}

void answer_with(const json& value) { answer().text = tangi::json_line(value); }

void answer_with(Easel::BoardPicture picture) {
    const tangi::Region& r = picture.region;
    answer_with(json{{"width", picture.width},
                     {"height", picture.height},
                     {"x", r.x0},
                     {"y", r.y0},
                     {"columns", r.width()},
                     {"rows", r.height()}});
    answer().bytes = std::move(picture.rgba);
}

tangi::RgbaPicture rgba(const std::uint8_t* bytes, int width, int height) {
    return {width, height, {bytes, static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4}};
}

tangi::Place place_of(int palette) { return palette ? tangi::Place::palette : tangi::Place::painting; }

}  // namespace

extern "C" {

EMSCRIPTEN_KEEPALIVE const char* tp_text() { return answer().text.c_str(); }
EMSCRIPTEN_KEEPALIVE const std::uint8_t* tp_bytes() { return answer().bytes.data(); }
EMSCRIPTEN_KEEPALIVE int tp_byte_count() { return static_cast<int>(answer().bytes.size()); }

// `choice`: make_ground()'s, and "undo_bytes".
EMSCRIPTEN_KEEPALIVE int tp_open(const char* choice, const std::uint8_t* picture, int width, int height,
                                 const std::uint8_t* relief, int relief_width, int relief_height) {
    return guarded([&] {
        const json chosen = tangi::read_json(choice, "the choice of a support");
        easel().reset();
        easel().emplace(tangi::make_ground(chosen, rgba(picture, width, height),
                                           rgba(relief, relief_width, relief_height)),
                        chosen.value("undo_bytes", Easel::kUndoBytes));
        answer_with(open_easel().picture());
    });
}
// The same for what is open, on a ground of the same relief.
EMSCRIPTEN_KEEPALIVE int tp_lie_on(const char* choice, const std::uint8_t* picture, int width, int height,
                                   const std::uint8_t* relief, int relief_width, int relief_height) {
    return guarded([&] {
        open_easel().lie_on(tangi::make_ground(tangi::read_json(choice, "the choice of a support"),
                                               rgba(picture, width, height),
                                               rgba(relief, relief_width, relief_height)));
        answer_with(open_easel().picture());
    });
}
EMSCRIPTEN_KEEPALIVE int tp_head() {
    return guarded([&] { answer_with(json(open_easel().head())); });
}
// A painting file of so many bytes, which the page reads.
EMSCRIPTEN_KEEPALIVE int tp_open_painting(double file_bytes, double memory_bytes, double undo_bytes) {
    return guarded([&] {
        easel().reset();
        easel().emplace(tangi::painting_from_bytes(page_file(file_bytes), memory_bytes),
                        static_cast<std::size_t>(undo_bytes));
        answer_with(open_easel().picture());
    });
}
// What is on the easel as a painting file; the page reads the one that it is painted on, which has so many
// bytes, 0 where there was none. Answers {"blocks"}, and with the file's head as bytes.
EMSCRIPTEN_KEEPALIVE int tp_begin_file(double original_bytes) {
    return guarded([&] {
        painting_file().reset();
        painting_file().emplace(open_easel().session().canvas(), page_file(original_bytes));
        answer_with(json{{"blocks", painting_file()->blocks()}});
        const std::string head = painting_file()->head();
        answer().bytes.assign(head.begin(), head.end());
    });
}
EMSCRIPTEN_KEEPALIVE int tp_file_block(int number, int sorted) {
    return guarded([&] {
        if (!painting_file()) tangi::fail("no file is being written");
        const auto block = painting_file()->block(static_cast<std::size_t>(number), sorted != 0);
        answer_with(json{{"part", block.part}, {"y", block.y}, {"packed", block.packed}});
        answer().bytes.assign(block.bytes.begin(), block.bytes.end());
    });
}
EMSCRIPTEN_KEEPALIVE int tp_end_file() {
    return guarded([] { painting_file().reset(); });
}
EMSCRIPTEN_KEEPALIVE int tp_begin(const char* first_line) {
    return guarded([&] { open_easel().begin(first_line); });
}
EMSCRIPTEN_KEEPALIVE int tp_apply(const char* line) {
    return guarded([&] { answer().text = open_easel().apply(line); });
}
// [[x0, y0, x1, y1], …]
EMSCRIPTEN_KEEPALIVE int tp_refresh(int all) {
    return guarded([&] {
        json regions = json::array();
        for (const tangi::Region& r : open_easel().refresh(all != 0))
            regions.push_back({r.x0, r.y0, r.x1, r.y1});
        answer_with(regions);
    });
}
EMSCRIPTEN_KEEPALIVE int tp_texels(int level, int x0, int y0, int x1, int y1) {
    return guarded([&] {
        const std::vector<tangi::Texel> texels = open_easel().texels(level, {x0, y0, x1, y1});
        const auto* begin = reinterpret_cast<const std::uint8_t*>(texels.data());
        answer().bytes.assign(begin, begin + texels.size() * sizeof(tangi::Texel));
    });
}
EMSCRIPTEN_KEEPALIVE int tp_board(int whole) {
    return guarded([&] {
        if (auto changes = open_easel().board_changes(whole != 0)) answer_with(std::move(*changes));
    });
}
EMSCRIPTEN_KEEPALIVE int tp_on_brush() {
    return guarded([&] { answer_with(open_easel().on_brush()); });
}
EMSCRIPTEN_KEEPALIVE int tp_sample(int palette, double x_mm, double y_mm, double radius_mm) {
    return guarded([&] { answer_with(open_easel().sample(place_of(palette), x_mm, y_mm, radius_mm)); });
}
EMSCRIPTEN_KEEPALIVE int tp_paints() {
    return guarded([&] { answer_with(open_easel().paints()); });
}
EMSCRIPTEN_KEEPALIVE int tp_brushes() {
    return guarded([&] {
        json all = json::object();
        for (const auto& [name, settings] : tangi::brush_presets())
            all[name] = tangi::brush_to_json(settings);
        answer_with(all);
    });
}
EMSCRIPTEN_KEEPALIVE int tp_state() {
    return guarded([&] { answer_with(open_easel().state()); });
}
EMSCRIPTEN_KEEPALIVE int tp_hash() {
    return guarded([&] {
        answer_with(json{{"canvas", open_easel().hash()}, {"look", open_easel().look_hash()}});
    });
}
EMSCRIPTEN_KEEPALIVE int tp_thumbnail(int width) {
    return guarded([&] { answer_with(open_easel().thumbnail(width)); });
}
EMSCRIPTEN_KEEPALIVE int tp_layers() {
    return guarded([&] { answer_with(json(open_easel().layer_names())); });
}
EMSCRIPTEN_KEEPALIVE int tp_layer(int number) {
    return guarded([&] { answer_with(open_easel().layer_picture(static_cast<std::size_t>(number))); });
}
EMSCRIPTEN_KEEPALIVE int tp_horizon(int largest_side) {
    return guarded([&] {
        Easel::Horizon horizon = open_easel().horizon(largest_side);
        answer_with(json{{"width", horizon.width}, {"height", horizon.height}});
        answer().bytes = std::move(horizon.values);
    });
}
EMSCRIPTEN_KEEPALIVE int tp_totals() {
    return guarded([&] {
        const auto& totals = open_easel().session().totals();
        answer_with(json{{"strokes", totals.strokes},
                         {"points", totals.points},
                         {"bristle_pixels", totals.bristle_pixels}});
    });
}

}  // extern "C"
