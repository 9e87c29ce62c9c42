// sample_writer.h: samples to picture files, strip by strip, through OpenImageIO.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "surface/image_file/picture_notes.h"

namespace tangi {

enum class SampleDepth { eight, sixteen, real };

// How samples are stored.
struct SampleStorage {
    int channels;
    SampleDepth depth;
    std::string colour_space;
    int jpeg_quality = 95;
    bool is_srgb = false;
    PictureNotes notes{};
};

class SampleWriter {
public:
    // Throws Error where the file cannot be written.
    SampleWriter(const std::filesystem::path& path, int width, int height, const SampleStorage& storage);
    ~SampleWriter();
    SampleWriter(SampleWriter&&) noexcept;

    // The rows [begin, end), interleaved; from top to bottom, in whole blocks of 256 but for the last.
    void write(int begin, int end, const float* rows);
    // Puts the file in place. Throws Error, as on a full disk.
    void commit();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace tangi
