// ptm_rti_file.h: .ptm and .rti files, as RTI viewers open them.
//
// .ptm: version 1.2 (Malzbender, Gelb 2001, "Polynomial texture map (.ptm) file format"), PTM_FORMAT_RGB or
// PTM_FORMAT_LRGB, uncompressed: a coefficient is (byte - bias) * scale, of values 0..255, with one scale and
// one bias for each of the six terms; rows from the bottom up. .rti: #HSH1.2 with 4, 9 or 16 harmonics for
// each of red, green and blue: a coefficient is byte / 255 * scale + bias, of values 0..1; rows from the top
// down.
#pragma once

#include <filesystem>

#include "fit/exchange/ptm_hsh.h"
#include "surface/file/atomic_file.h"

namespace tangi {

// Whole or not at all. The range of each term is the one whose bytes err least (its largest values may be cut
// off). A basis and an extension that do not go together (.ptm: ptm; .rti: harmonics, not lrgb), and files
// that cannot be written, throw Error.
void write_rti_file(AtomicFile& file, const RtiImage& image, const Progress& progress = {});

// Either of them, by its content. Throws Error naming the file and what is wrong: another format
// (JPEG-compressed, look-up tables), a damaged header, a size that is not the file's.
RtiImage read_rti_file(const std::filesystem::path& path);

}  // namespace tangi
