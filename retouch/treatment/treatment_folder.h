// treatment_folder.h: how files come into a treatment's folder: a step's lie in pending/, as they are to lie
// in the folder, until its line is in the log, and are then put in their places. So of a step that did not
// come to its end there is either all or nothing.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace tangi {

class TreatmentLog;

inline constexpr const char* kTreatmentLog = "log.jsonl";
inline constexpr const char* kTreatmentPainting = "painting.exr";
inline constexpr const char* kTreatmentMasks = "masks";
inline constexpr const char* kTreatmentEarlier = "earlier.exr";
inline constexpr const char* kTreatmentRemoved = "removed";
inline constexpr const char* kRemovedLayers = "layers";  // in `kept` of a line: the file of what it took off

// masks/NAME.png
std::filesystem::path treatment_mask(const std::string& name);

// The folder of the treatment that keeps this file, or would keep one of its name: its painting, log, masks,
// and what else its steps write. Nobody else writes there.
std::optional<std::filesystem::path> treatment_that_keeps(const std::filesystem::path& file);

// Of a painting in tiles, as one file. Throws Error naming both.
void copy_whole(const std::filesystem::path& from, const std::filesystem::path& to,
                const Progress& progress = {});

// Throws Error where the file is not what a line of the log wrote.
void require_logged(const std::filesystem::path& file, const std::string& sha256, int line);

// What a step left pending, because a crash came into it, is put in its place where the step is in the log,
// and removed where it is not. Waits for a step that another program is just writing. Throws Error naming the
// file that cannot be moved.
void settle_pending(const std::filesystem::path& folder);

// Throws Error naming the line and its field where the log is not as Treatment writes it, though its chain
// holds: somebody wrote it anew.
void require_form(const TreatmentLog& log);

}  // namespace tangi
