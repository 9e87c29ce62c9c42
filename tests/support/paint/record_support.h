// record_support.h: whether the record of a painting makes what was saved.
#pragma once

#include <gtest/gtest.h>

#include "paint/files/canvas_file.h"
#include "paint/files/palette_part.h"
#include "paint/session/session.h"
#include "surface/base/error.h"
#include "viewer/model/crash_recovery.h"

namespace tangi {

// Whether two sittings ended with the same on painting, palette and brush, bit for bit.
inline testing::AssertionResult same_paint(const Session& a, const Session& b) {
    const auto layers = [](const Session& s) { return s.canvas().dried().size(); };
    if (!identical(a.canvas().wet(), b.canvas().wet()))
        return testing::AssertionFailure() << "wet paint differs";
    if (layers(a) != layers(b))
        return testing::AssertionFailure() << layers(a) << " dried layers and " << layers(b);
    for (std::size_t i = 0; i < layers(a); ++i)
        if (a.canvas().dried()[i].name != b.canvas().dried()[i].name ||
            !identical(a.canvas().dried()[i].paint, b.canvas().dried()[i].paint))
            return testing::AssertionFailure() << "dried layer " << i << " differs";
    if (a.board() && b.board() && !identical(a.board()->wet(), b.board()->wet()))
        return testing::AssertionFailure() << "the palette differs";
    if (a.brush() && b.brush() && a.brush()->bristles().total_mm != b.brush()->bristles().total_mm)
        return testing::AssertionFailure() << "the brush differs";
    return testing::AssertionSuccess();
}

// Whether the record of a painting makes of its ground what was saved.
inline testing::AssertionResult recorded_as_saved(const std::filesystem::path& painting) {
    Session saved(read_canvas(painting), artist_acrylics());
    read_tools(painting, saved);
    Session again(Canvas(saved.canvas().dry_shared()), artist_acrylics());
    try {
        if (const auto record = recovery_files(painting).record; std::filesystem::exists(record))
            replay(again, read_journal(record));
    } catch (const Error& error) {
        return testing::AssertionFailure() << error.what();
    }
    return same_paint(again, saved);
}

}  // namespace tangi
