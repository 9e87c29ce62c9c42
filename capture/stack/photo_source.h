// photo_source.h: one photograph of a stack, read a few rows at a time: as stored, or developed.
#pragma once

#include <span>
#include <vector>

#include "capture/photo/photo_file.h"
#include "capture/stack/stack.h"

namespace tangi {

class ProfileConversion;

class PhotoSource {
public:
    // Keeps a reference to the stack. Throws as PhotoFile.
    PhotoSource(const Stack& stack, const StackPhoto& photo);

    // Floats that are codes are those of integers of 16 bits.
    const PhotoHeader& header() const { return header_; }

    // As PhotoFile::read_rows(), in units of Stack::full_scale; of integers 1 at most. Of a stack that is
    // developed: linear light (development.h), not below 0; what is clipped has the value
    // Development::clipped in all channels that it touches, everything else is less; NaN where the flat field
    // tells nothing, or a photograph or frame has no sample.
    void read_rows(int y0, int y1, std::span<float> values);

    // As PhotoFile::without_number() and transparent(), of all its files.
    long without_number() const;
    long transparent() const;

private:
    void read_stored(std::size_t exposure, int y0, int y1, std::span<float> values);

    const Stack& stack_;
    PhotoHeader header_;
    std::vector<PhotoFile> files_;
    std::vector<const ProfileConversion*> profiles_;  // of files that have another ICC profile; else null
    std::vector<int> raws_;  // in the scratch file; -1 for what is read from its own file
    std::vector<float> relative_;
    std::vector<float> stored_, dark_, ambient_, gain_;  // rows
    std::vector<std::uint16_t> codes_;
};

}  // namespace tangi
