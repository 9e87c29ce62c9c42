// treatment_folder.h: a treatment of a small painting, for tests.
#pragma once

#include <gtest/gtest.h>

#include "retouch/treatment/treatment.h"
#include "surface/painting_file/painting_file.h"
#include "tests/support/paint/paint_support.h"
#include "tests/support/test_support.h"

namespace tangi {

inline const Author kAuthor{"A. Restorer", "tangipaint test"};

// A painting of 100 x 70 pixels in a treatment.
class TreatmentFolder : public testing::Test {
protected:
    TreatmentFolder() {
        auto surface = flat_surface(100, 70);
        for (int y = 0; y < 70; ++y)
            for (int x = 0; x < 100; ++x) surface->height_mm(x, y) = 0.01f * static_cast<float>(x % 7);
        write_painting(dir_ / "p.exr", *surface);
    }
    Treatment begin() { return Treatment::begin(folder(), dir_ / "p.exr", kAuthor); }
    std::filesystem::path folder() const { return dir_ / "p.treatment"; }

    // A layer of paint in a square.
    static void lay(Canvas& canvas, const std::string& name, int x0, int size) {
        const IngredientId white = add_paint(canvas, "Titanium White");
        PaintLayer paint(canvas.width(), canvas.height());
        for (int y = 10; y < 10 + size; ++y)
            for (int x = x0; x < x0 + size; ++x)
                paint.writable({x / 64, y / 64})
                    .writable_plane(white)[static_cast<std::size_t>((y % 64) * 64 + x % 64)] = 0.1f;
        canvas.writable_dried().push_back({name, paint});
    }
    static void add(Treatment& treatment, LayerRole role, int x0, int size = 8) {
        Canvas canvas = treatment.read_canvas();
        const std::string name = treatment.new_layer_name(role);
        lay(canvas, name, x0, size);
        treatment.record({.action = "test", .canvas = &canvas, .added = {{name, role}}}, kAuthor);
    }

    TestDir dir_;
};

}  // namespace tangi
