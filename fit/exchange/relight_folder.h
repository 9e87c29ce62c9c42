// relight_folder.h: folders that Relight and OpenLIME show: info.json and plane_0.jpg, plane_1.jpg, …
//
// Of the kinds there are, ptm and hsh in rgb (three planes a picture: one term of red, green and blue) are
// written; these and lrgb are read. A coefficient is (byte / 255 - bias) * scale, of values 0..1; the terms
// of ptm are 1, x, y, x^2, xy, y^2.
#pragma once

#include <filesystem>

#include "fit/exchange/ptm_hsh.h"

namespace tangi {

// JPEG planes of quality 95, and info.json. Throws Error where the folder cannot be written.
void write_relight_folder(const std::filesystem::path& folder, const RtiImage& image, double mm_per_pixel,
                          const Progress& progress = {});

// Throws Error naming the file: no info.json, another kind, a plane that is missing or of another size.
RtiImage read_relight_folder(const std::filesystem::path& folder);

bool is_relight_folder(const std::filesystem::path& folder);

}  // namespace tangi
