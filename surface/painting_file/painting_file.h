// painting_file.h: a painting as one multi-part OpenEXR file; part `dry` holds the fitted Surface.
//
// Channels (32-bit float): height [mm], normal.X/Y/Z, diffuse.R/G/B, specular, roughness, confidence,
// and lobe.R/G/B where lobes have colours, roughness.V and tangent where they are anisotropic. Attributes:
// mm_per_pixel, scale_known, photography (JSON),
// provenance (JSON), dry_hash. docs/reference/quantities.md has all.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "surface/base/progress.h"
#include "surface/file/atomic_file.h"
#include "surface/maps/surface.h"

namespace tangi {

constexpr int kPaintingFormatVersion = 2;  // 1, or none: of version 0.1 (docs/reference/formats.md)

// Writes whole or not at all. Throws Error naming the file on a full disk, a missing folder, …
void write_painting(const std::filesystem::path& path, const Surface& surface, const Progress& progress = {});

// The same into a file that was reserved before (see AtomicFile); commits it.
void write_painting(AtomicFile& file, const Surface& surface, const Progress& progress = {});

// Throws Error naming the file and what is wrong: not an EXR, truncated, no part `dry`, a channel missing,
// maps whose content no longer has the hash that was stored, and values that cannot be relit where confidence
// is not 0: not finite, roughness below 1e-6, roughness.V likewise, a lobe's colour beyond 0..1, normals that
// are no unit vectors (off by up to 1 % they are normalised). Where confidence is 0 such a pixel becomes one
// that was not measured (surface.h).
Surface read_painting(const std::filesystem::path& path, const Progress& progress = {});

// True where the file is an EXR with a part `dry`; false for any other file.
bool is_painting(const std::filesystem::path& path);

// 64-bit FNV-1a over the maps, row by row, as 16 hex digits: proof that a dry layer has not changed.
std::string hash_of(const Surface& surface);

// [mm] A scale as files give it back, which keep it as a float: the shortest number that is this float, so
// that 0.3 is 0.3 again and not 0.30000001192. Who makes a surface takes it, that it be the same when read.
double kept_scale_mm(double mm_per_pixel);

}  // namespace tangi
