// develop_stack.h: a stack made linear before it is read: raws decoded, frames averaged, brackets related.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "capture/radiometry/frames.h"
#include "capture/radiometry/transfer_estimate.h"
#include "capture/stack/stack.h"
#include "surface/base/progress.h"

namespace tangi {

struct DevelopReport {
    struct Setting {           // an exposure that brackets were taken with
        double given = 1;      // [1] as the file or EXIF says, reference = 1
        double relative = 1;   // [1] as used
        double scatter = 0;    // [1] of its ratio to the setting below, between lights
        bool refined = false;  // found in the photographs
    };
    bool developed = false;       // false: the stack needs no development and is as it was
    TransferEstimate encoding{};  // of the files
    std::optional<FrameSummary> dark{}, flat{}, ambient{};
    std::vector<Setting> settings{};  // ascending; empty without brackets
    std::string camera{};             // of raws
    DevelopOptions options{};
    std::uint64_t scratch_bytes = 0;  // on disk while the stack lives
};

struct DevelopRun {
    // Raws are decoded once into a scratch file of 6 bytes a pixel and photograph. False: each time they are
    // read from the top, for who reads them once and one at a time.
    bool keep_raws = true;
};

// Sets stack.development where the stack holds camera raws or stack.develop asks for something, as
// development.h says; values are linear from then on, and bits is 32. Where the transfer curve is not known,
// it is estimated from the photographs as they are. Warnings go to stack.warnings. Throws Error naming the
// file and the remedy: frames of another size, that are clipped or black, brighter than the photographs; a
// disk that is full.
DevelopReport develop_stack(Stack& stack, const DevelopRun& run = {}, const Progress& progress = {});

// What was done, for results and provenance; null where nothing was.
nlohmann::json to_json(const DevelopReport& report);

}  // namespace tangi
