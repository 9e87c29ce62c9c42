// lights_format.h: the table of formats that lights are read from: how each is known, and what reads it.
//
// Whoever is given a lights file asks this table: fit, relight, compare and info read the same formats. A
// further format is a source that reads it, and one row (docs/developer/how-to.md).
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "capture/formats/capture_file.h"
#include "capture/photo/rejected_photo.h"
#include "surface/maps/light.h"

namespace tangi {

// What a file of any of the formats says.
struct LightList {
    std::vector<Light> lights;  // in the file's order; gains 1; positions all or none; names may be empty
    std::vector<std::string> warnings{};
    std::vector<RejectedPhoto> rejected{};  // entries that are no light, told in the warnings too
    std::vector<double> lengths{};          // of bare vectors: distances, where these are positions
    int decimals = 0;                       // most that a component of a bare vector is given with
    // Of formats that say what their vectors are. One without a size (0 x 0) is of whatever size the
    // photographs have.
    std::optional<CaptureFile> capture{};
    std::optional<double> picture_width_mm{};  // of the photographs on the plane of the painting
};

// Whether a folder is searched for a file of this format.
enum class LightsSearch {
    first,
    second,  // where there is none of the first kind
    never    // it has to be named
};

struct LightsFormat {
    std::string_view name;       // as messages have it: "lights file"
    std::string_view extension;  // with the point, in lower case; no two rows share one
    LightsSearch search = LightsSearch::second;
    bool bare_vectors = false;  // whose frame and unit the user may have to say (--light-axes, --lights-mm)
    bool is_capture = false;    // capture.json, which may also lie beside a lights file of another format
    bool shares_extension = false;                     // with files of other kinds: only sniff() tells
    bool is_written = false;                           // by `tangipaint calibrate`
    bool (*sniff)(const std::string& text) = nullptr;  // whether a whole file is of this format and no other
    LightList (*read)(const std::filesystem::path& path) = nullptr;  // throws Error naming file and place
};

// The table, in the order in which messages list the formats.
std::span<const LightsFormat> lights_formats();

// The format that an extension means, in any case; null where it means none.
const LightsFormat* lights_format_named(const std::filesystem::path& path);

// The format of a file that is given for a lights file: by its extension; where that means none, by its text;
// else bare vectors (.lp), whose reader says what is wrong. The file need not be there.
const LightsFormat& lights_format_of(const std::filesystem::path& path);

// Whether a file that might be anything is a lights file.
bool is_lights_file(const std::filesystem::path& path);

// By whatever format the file is of. Throws Error naming file and place.
LightList read_lights(const std::filesystem::path& path);

// The extensions of those that `wanted` takes, or of all, for messages: ".lp, .dome or .relight".
std::string extensions_in_words(bool (*wanted)(const LightsFormat&) = nullptr);

}  // namespace tangi
