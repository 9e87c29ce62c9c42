// substrate_arguments.h: --substrate and what goes with it: what a new painting is painted on.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/flags.h"
#include "paint/picture_substrate.h"
#include "paint/substrate.h"
#include "surface/progress.h"

namespace tangi {

struct SubstrateArguments {
    std::string which, height_from = "luminance", keep_as;
    SubstrateOptions piece;
    PictureSubstrateOptions picture;
    std::function<std::vector<std::string>()> typed;  // flags of the command

    void add_to(Flags& flags);
    bool given() const { return !which.empty(); }
    // Throws UsageError for a substrate of no such name, and for flags that this substrate, or a painting
    // that is given instead, has no use for.
    void refuse_useless() const;
    // A procedure's piece, a picture, a painting file's dry layer, or one that was kept under a name; and
    // keeps it where --keep-substrate says so. Throws UsageError, Error.
    Surface make(const Progress& progress) const;
    std::vector<std::filesystem::path> inputs() const;  // files that it is made of
};

}  // namespace tangi
