// annotation_document.h: the annotations of a painting and their files.
//
// Beside x.exr: x.annotations.json, which `tangipaint export --annotations` takes; and, while there are some
// that were not saved, x.annotations.unsaved.json, which survives a crash. What another program made of the
// first one meanwhile, or what could not be read, is kept under another name.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "surface/file/file_stamp.h"
#include "viewer/annotations/annotation_list.h"

namespace tangi {

struct AnnotationFiles {
    std::filesystem::path painting, saved, unsaved;
};
AnnotationFiles annotation_files(const std::filesystem::path& painting);

class AnnotationDocument {
public:
    AnnotationDocument() = default;
    // Those of a painting; of what was not saved, undoing leads back to what was. `only_looks`: another
    // window has the painting: its unsaved ones are not ours, and nothing is written. What is to be said is
    // in said().
    AnnotationDocument(const std::filesystem::path& painting, const AnnotatedPicture& picture,
                       bool only_looks);

    AnnotationList& list() { return list_; }
    const AnnotationList& list() const { return list_; }
    const AnnotationFiles& files() const { return files_; }
    bool only_looks() const { return only_looks_; }

    // Throws Error where they cannot be written: then they are not saved, and kept as such.
    void save();
    // The painting has been saved under another name: they are saved beside it. Those that lie there are of
    // the painting that it has replaced.
    void save_beside(const std::filesystem::path& painting);
    // What was changed since the last call is on the disk, too. Throws Error where it cannot be written.
    void keep();
    // Adds those of a file; how many there are, and how many reach beyond the painting. Throws Error where
    // something is wrong: then none is added.
    struct Loaded {
        std::size_t count = 0, beyond = 0;
    };
    Loaded load(const std::filesystem::path& file);
    // Writes them to another file, which is not the painting's.
    void write_to(const std::filesystem::path& file) const;

    std::vector<std::string> said() { return std::exchange(said_, {}); }

private:
    void read_unsaved();
    void make_way(const char* why, const std::string& words);

    AnnotationFiles files_;
    AnnotationList list_;
    Annotations kept_;                // in the unsaved file
    bool keeps_ = false;              // that file is there
    std::optional<FileStamp> stamp_;  // of the saved one, as it was read or written last
    bool is_bad_ = false, only_looks_ = false;
    std::vector<std::string> said_;
};

}  // namespace tangi
