#include "retouch/treatment/confining_mask.h"

#include "surface/base/error.h"
#include "surface/file/atomic_file.h"
#include "surface/file/sha256.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr const char* kMasksOfStrokes = "masks";

}  // namespace

ConfiningMask confining_mask(const fs::path& folder, const Mask& mask) {
    AtomicFile file(folder / "confining.png");  // never put in place
    write_mask(file.temporary(), mask);
    ConfiningMask kept;
    kept.png = read_text_file(file.temporary());
    kept.name = sha256_of(kept.png);
    kept.mask = std::make_shared<const Mask>(read_mask(file.temporary(), mask.width(), mask.height()));
    return kept;
}

std::string confining_mask_file(const std::string& name) {
    return fmt::format("strokes/{}/{}.png", kMasksOfStrokes, name);
}

Session::Masks masks_beside(fs::path journal, int width, int height) {
    return [journal = std::move(journal), width, height](const std::string& name) {
        const fs::path folder = journal.parent_path(),
                       in_strokes = folder / kMasksOfStrokes / (name + ".png");
        std::error_code unknown;
        const fs::path file =
            fs::exists(in_strokes, unknown) ? in_strokes : folder / confining_mask_file(name);
        if (!fs::exists(file, unknown))
            fail("the mask that brushes stopped at, {}, is not there; take it from a backup, to {}",
                 file.filename().string(), file.parent_path().string());
        if (sha256_of_file(file) != name)
            fail("{}: is not the mask that brushes stopped at; take it from a backup", file.string());
        return std::make_shared<const Mask>(read_mask(file, width, height));
    };
}

}  // namespace tangi
