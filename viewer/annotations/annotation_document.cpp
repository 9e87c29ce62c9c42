#include "viewer/annotations/annotation_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "surface/base/error.h"
#include "surface/file/atomic_file.h"
#include "surface/file/file_name.h"

namespace tangi {

namespace fs = std::filesystem;

AnnotationFiles annotation_files(const fs::path& painting) {
    return {painting, beside_painting(painting, "annotations.json"),
            beside_painting(painting, "annotations.unsaved.json")};
}

AnnotationDocument::AnnotationDocument(const fs::path& painting, const AnnotatedPicture& picture,
                                       bool only_looks)
    : files_(annotation_files(painting)), list_({}, picture), only_looks_(only_looks) {
    try {
        stamp_ = stamp_of(files_.saved);
        const std::string name = files_.saved.filename().string();
        if (stamp_)
            list_ = AnnotationList(annotations_of(read_annotations(files_.saved.string(), name), picture),
                                   picture);
    } catch (const Error& error) {
        is_bad_ = true;
        said_.emplace_back(error.what());
    }
    if (only_looks_ || !file_exists(files_.unsaved)) return;
    try {
        read_unsaved();
    } catch (const Error& error) {  // what cannot be read cannot be renamed, either
        said_.emplace_back(error.what());
    }
}

void AnnotationDocument::read_unsaved() {
    const std::string name = files_.unsaved.filename().string();
    try {
        list_.replace(annotations_of(read_annotations(files_.unsaved.string(), name), list_.picture()));
        keeps_ = true;
        kept_ = list_.now();
        if (list_.unsaved())
            said_.emplace_back(
                "annotations that were not saved are here again; undo leads back to those that were");
        else
            keep();  // a program that was killed between saving and removing it
    } catch (const Error& error) {
        said_.emplace_back(error.what());
        said_.push_back(fmt::format(
            "it is kept as {}", put_aside(files_.unsaved, files_.painting, "annotations.unread", "json")));
    }
}

// What lies where they are to be saved, and is not what was read or written last, gets another name.
void AnnotationDocument::make_way(const char* why, const std::string& words) {
    said_.push_back(
        fmt::format("{} {}, and is kept as {}", files_.saved.filename().string(), words,
                    put_aside(files_.saved, files_.painting, fmt::format("annotations.{}", why), "json")));
}

void AnnotationDocument::save() {
    const auto there = stamp_of(files_.saved);
    if (there && is_bad_)
        make_way("unread", "could not be read");
    else if (there && there != stamp_)
        make_way("other", "was changed by another program");
    write_text_file(files_.saved, text_of_page(json_of(list_.now())));
    stamp_ = stamp_of(files_.saved);
    is_bad_ = false;
    list_.is_saved();
    keep();
}

void AnnotationDocument::save_beside(const fs::path& painting) {
    const AnnotationFiles left = std::exchange(files_, annotation_files(painting));
    if (left.saved == files_.saved) return;
    only_looks_ = is_bad_ = false;
    stamp_.reset();
    if (std::exchange(keeps_, false)) {
        std::error_code stays;  // then they are there again when that painting is opened
        fs::remove(left.unsaved, stays);
    }
    kept_.clear();
    if (file_exists(files_.saved)) make_way("other", "is of the painting that was there before");
    if (!list_.now().empty()) save();
}

void AnnotationDocument::keep() {
    if (only_looks_) return;
    if (!list_.unsaved()) {
        std::error_code stays;  // then it says what is saved, too
        if (std::exchange(keeps_, false)) fs::remove(files_.unsaved, stays);
        kept_.clear();
    } else if (!keeps_ || kept_ != list_.now()) {
        write_text_file(files_.unsaved, text_of_page(json_of(list_.now())));
        keeps_ = true;
        kept_ = list_.now();
    }
}

AnnotationDocument::Loaded AnnotationDocument::load(const fs::path& file) {
    const std::string name = file.filename().string();
    const AnnotatedPicture& picture = list_.picture();
    const Annotations read = annotations_of(read_annotations(file.string(), name), picture);
    const auto is_beyond = [&](const glm::dvec2& p) {
        return p.x < -1 || p.y < -1 || p.x > picture.width || p.y > picture.height;
    };
    Loaded loaded{read.size(), 0};
    for (const auto& annotation : read)
        if (std::ranges::any_of(annotation->shape.rings,
                                [&](const auto& ring) { return std::ranges::any_of(ring, is_beyond); }))
            ++loaded.beyond;
    list_.merge(read);
    std::error_code other;
    if (fs::equivalent(file, files_.saved, other)) {  // what another program made of it is known now
        stamp_ = stamp_of(files_.saved);
        is_bad_ = false;
    }
    return loaded;
}

void AnnotationDocument::write_to(const fs::path& file) const {
    write_text_file(file, text_of_page(json_of(list_.now())));
}

}  // namespace tangi
