// substrate_arguments.h: --substrate and what goes with it: what a new painting is painted on.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/flags.h"
#include "paint/substrate/substrate_choice.h"
#include "surface/base/progress.h"

namespace tangi {

struct SubstrateArguments {
    SubstrateChoice choice;
    std::string tint;
    std::function<std::vector<std::string>()> typed;  // flags of the command

    void add_to(Flags& flags);
    bool given() const { return !choice.which.empty(); }
    // Throws UsageError for a substrate of no such name, and for flags that this substrate, or a painting
    // that is given instead, has no use for.
    void refuse_useless() const;
    bool assumes_scale() const;                         // of a picture without --pixel-mm
    std::vector<std::string> warnings() const;          // that it does
    Surface make(const Progress& progress) const;       // make_substrate(); throws Error
    std::vector<std::filesystem::path> inputs() const;  // files that it is made of
};

}  // namespace tangi
