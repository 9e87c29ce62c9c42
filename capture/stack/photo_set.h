// photo_set.h: the photographs of a stack whose lights are not known yet, as calibration reads them: as
// stored, or developed (raw, frames, brackets).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "capture/photo/photo_metadata.h"
#include "capture/stack/photo_source.h"
#include "capture/stack/stack.h"

namespace tangi {

class PhotoSet {
public:
    // As stored; each path is a photograph. Implicit: a list of photographs is one.
    PhotoSet(const std::vector<std::filesystem::path>& paths);
    // Photographs as a stack has them, its lights not used; developed where the stack is, and then scaled so
    // that what is clipped is 1.
    explicit PhotoSet(Stack stack) : stack_(std::move(stack)) {}

    std::size_t size() const { return stack_.photos.size(); }
    const std::filesystem::path& path(std::size_t photo) const { return stack_.photos[photo].path; }
    // The light's: that of the file, or of its bracket.
    std::string name(std::size_t photo) const { return stack_.photos[photo].light.name; }
    std::filesystem::path folder() const { return path(0).parent_path(); }
    // How the files of developed photographs are encoded.
    std::optional<Transfer> encoding() const {
        return developed() ? std::optional(stack_.development->encoding) : std::nullopt;
    }
    bool developed() const { return stack_.development != nullptr; }
    // What the photograph's file says, once it is read as the others (photo_profiles.h).
    PhotoMetadata metadata(std::size_t photo) const;

    // An open photograph; it keeps a reference to the set.
    class Reader {
    public:
        Reader(const PhotoSet& set, std::size_t photo)
            : set_(set), source_(set.stack_, set.stack_.photos[photo]) {}
        const PhotoHeader& header() const { return source_.header(); }
        void read_rows(int y0, int y1, std::span<float> values);  // as PhotoFile::read_rows()
        // Linear light of these rows; grey becomes RGB. `transfer` as for linear().
        Image<Rgb> linear_rows(int y0, int y1, const Transfer& transfer);

    private:
        const PhotoSet& set_;
        PhotoSource source_;
    };
    // Throws Error naming the file.
    Reader open(std::size_t photo) const { return Reader(*this, photo); }

    // Linear light of a whole photograph; grey becomes RGB. `transfer` is of the files, and does not matter
    // where they were developed or are camera raw.
    Image<Rgb> linear(std::size_t photo, const Transfer& transfer) const;

    // The photographs from the brightest to the darkest, by the mean of green. Reads all.
    std::vector<std::size_t> brightest_first(const std::string& what, const Progress& progress) const;

private:
    Stack stack_;
};

}  // namespace tangi
