#include "retouch/treatment/treatment_folder.h"

#include <algorithm>
#include <fstream>
#include <functional>
#include <set>
#include <vector>

#include "retouch/treatment/treatment_log.h"
#include "retouch/treatment/treatment_pending.h"
#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"
#include "surface/file/atomic_folder.h"
#include "surface/file/sha256.h"
#include "surface/painting_file/painting_tiles.h"

namespace tangi {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

// In it: the hash of the line that the step's line is to follow.
constexpr const char* kStepFile = "step.json";
constexpr int kMostPixels = 1 << 20;  // of a side: more is no picture

using Holds = std::function<bool(const json&)>;

bool is_text(const json& v) { return v.is_string(); }

// A path that stays in the folder.
bool is_inside(const json& v) { return v.is_string() && stays_inside(v.get<std::string>()); }

Holds list_of(const Holds& holds) {
    return [holds](const json& v) {
        return v.is_array() && std::all_of(v.begin(), v.end(), [&](const json& item) { return holds(item); });
    };
}

Holds texts(bool by_path) {
    return [by_path](const json& v) {
        if (!v.is_object()) return false;
        for (const auto& [name, text] : v.items())
            if (!text.is_string() || (by_path && !stays_inside(name))) return false;
        return true;
    };
}

bool is_layer(const json& v) {
    if (!v.is_object()) return false;
    for (const char* field : {"name", "role", "sha256"})
        if (!v.contains(field) || !v[field].is_string()) return false;
    const std::string name = v["name"].get<std::string>();
    return !name.empty() && name.size() <= kMostOfName && is_one_line(name);
}

bool names_files(const json& v) { return v.is_object() && std::all_of(v.begin(), v.end(), is_inside); }

struct LineField {
    const char* name;
    bool needed;
    Holds holds;
};

void require_fields(const TreatmentLog& log, const LogEntry& entry, const std::vector<LineField>& fields) {
    for (const LineField& field : fields) {
        const auto found = entry.content.find(field.name);
        if (found == entry.content.end() ? field.needed : !field.holds(*found))
            fail("{}:{}: {} '{}': the line was not written by this program; take the log from a backup",
                 log.path().string(), entry.line,
                 found == entry.content.end() ? "has no field" : "cannot have such a", field.name);
    }
}

const std::vector<LineField>& fields_of_a_first_line() {
    const auto is_side = [](const json& v) {
        return v.is_number_integer() && v.get<double>() >= 1 && v.get<double>() <= kMostPixels;
    };
    static const std::vector<LineField> fields = {
        {"width", true, is_side},
        {"height", true, is_side},
        {"mm_per_pixel", true,
         [](const json& v) { return v.is_number() && v.get<double>() > 0 && v.get<double>() < 1e6; }},
        {"scale_known", false, [](const json& v) { return v.is_boolean(); }},
        {"painting", false, is_text},
        {"dry_sha256", true, is_text}};
    return fields;
}

const std::vector<LineField>& fields_of_a_line() {
    const auto is_object = [](const json& v) { return v.is_object(); };
    static const std::vector<LineField> fields = {{"action", true, is_text},
                                                  {"time", false, is_text},
                                                  {"who", false, is_text},
                                                  {"tool", false, is_text},
                                                  {"parameters", false, is_object},
                                                  {"results", false, is_object},
                                                  {"inputs", false, texts(false)},
                                                  {"outputs", false, texts(true)},
                                                  {"layers", false, list_of(is_layer)},
                                                  {"kept", false, names_files},
                                                  {"withdrawn", false, list_of(is_inside)}};
    return fields;
}

// The line of the log that the pending step wrote; null where it wrote none.
const LogEntry* pending_line(const fs::path& pending, const TreatmentLog& log) {
    std::error_code missing;
    if (!fs::exists(pending / kStepFile, missing)) return nullptr;
    const json step = json_or_discarded(read_text_file(pending / kStepFile));
    if (!step.is_object() || !step.contains("previous")) return nullptr;
    for (const LogEntry& entry : log.entries())
        if (entry.content.at("previous") == step["previous"]) return &entry;
    return nullptr;
}

// Files of a step, relative to the folder of what is pending.
std::vector<fs::path> files_of_step(const fs::path& pending) {
    std::vector<fs::path> files;
    for (const auto& file : fs::recursive_directory_iterator(pending))
        if (file.is_regular_file() && file.path() != pending / kStepFile)
            files.push_back(file.path().lexically_relative(pending));
    return files;
}

// `files`: files_of_step().
void move_into_place(const fs::path& folder, const LogEntry& entry, const std::vector<fs::path>& files) {
    const fs::path pending = folder / kPending;
    const auto unfinished = [&](const fs::path& file, const std::string& why, const char* what) {
        fail("{}: cannot be {}: {}; the step is in the log, and the next command finishes it", file.string(),
             what, why);
    };
    std::set<fs::path> changed = {folder};
    for (const fs::path& file : files) {
        const fs::path place = folder / file;
        std::error_code failed;
        fs::create_directories(place.parent_path(), failed);
        if (!failed) fs::rename(pending / file, place, failed);
        if (failed) unfinished(place, failed.message(), "put in its place");
        changed.insert(place.parent_path());
    }
    for (const json& name : entry.content.value("withdrawn", json::array())) {
        std::error_code failed;
        fs::remove(folder / name.get<std::string>(), failed);
        if (failed) unfinished(folder / name.get<std::string>(), failed.message(), "removed");
    }
    for (const fs::path& names : changed) sync_folder(names, names);
    std::error_code left;
    fs::remove_all(pending, left);
    if (left) unfinished(pending, left.message(), "removed");
}

// What another step left would be taken for this one's.
void clear_pending(const fs::path& pending) {
    std::error_code failed;
    fs::remove_all(pending, failed);
    if (failed)
        fail("{}: is left of a step that did not come to its end, and cannot be removed: {}",
             pending.string(), failed.message());
}

// Folders for files of a step are made before its line is written; where it was not, they are as empty.
void remove_made_ahead(const fs::path& folder) {
    std::vector<fs::path> folders;
    std::error_code failed;
    for (fs::recursive_directory_iterator at(folder / kPending, failed), end; !failed && at != end;
         at.increment(failed))
        if (at->is_directory(failed)) folders.push_back(at->path().lexically_relative(folder / kPending));
    std::sort(folders.rbegin(), folders.rend());                             // inner ones first
    for (const fs::path& made : folders) fs::remove(folder / made, failed);  // not where it has files
}

// A log that is edited is one still.
bool is_treatment(const fs::path& folder) {
    std::ifstream log(folder / kTreatmentLog, std::ios::binary);
    std::string line;
    if (std::getline(log, line)) return line.find(kTreatmentFormat) != std::string::npos;
    return log.bad();  // for all that is known: a disk that fails is no leave to write over it
}

}  // namespace

std::optional<fs::path> treatment_that_keeps(const fs::path& file) {
    std::error_code unreadable;
    fs::path whole = fs::weakly_canonical(where_links_lead(file), unreadable);
    if (unreadable) return std::nullopt;
    if (!whole.has_filename()) whole = whole.parent_path();
    for (fs::path folder = whole.parent_path();; folder = folder.parent_path()) {
        if (is_treatment(folder)) {
            const std::string first = whole.lexically_relative(folder).begin()->string();
            const bool earlier = first.starts_with("earlier") && first.ends_with(".exr");
            const bool own =
                std::set<std::string>{kTreatmentLog, "log.head.json", kTreatmentPainting, kTreatmentMasks,
                                      "strokes",     "quality",       kTreatmentRemoved,  kPending}
                    .contains(first);
            if (own || earlier) return folder;
        }
        if (!folder.has_relative_path()) return std::nullopt;
    }
}

bool stays_inside(const std::string& path) {
    const fs::path p(path);
    return !path.empty() && p.is_relative() &&
           std::none_of(p.begin(), p.end(), [](const fs::path& part) { return part == ".."; });
}

fs::path treatment_mask(const std::string& name) { return fs::path(kTreatmentMasks) / (name + ".png"); }

void copy_whole(const fs::path& from, const fs::path& to, const Progress& progress) {
    if (is_tiled_painting(from)) return write_file(*open_painting(from), to, progress);
    AtomicFile file(to);
    file.copy_from(from);
    file.commit();
}

void require_logged(const fs::path& file, const std::string& sha256, int line) {
    if (!fs::exists(file) || sha256_of_file(file) != sha256)
        fail("{}: is not what line {} of the log wrote; take it from a backup", file.string(), line);
}

void settle_pending(const fs::path& folder) {
    const fs::path pending = folder / kPending;
    std::error_code missing;
    if (!fs::exists(pending, missing)) return;
    const LogHold held(folder / kTreatmentLog);
    if (!fs::exists(pending, missing)) return;  // another program was writing, and is done
    TreatmentLog log = TreatmentLog::open(folder / kTreatmentLog);
    require_form(log);
    const LogEntry* line = pending_line(pending, log);
    if (!line) {
        log.remove_torn_line(held);
        remove_made_ahead(folder);
        return clear_pending(pending);
    }
    log.complete_head(held);
    move_into_place(folder, *line, files_of_step(pending));
}

void require_form(const TreatmentLog& log) {
    require_fields(log, log.entries().front(), fields_of_a_first_line());
    for (const LogEntry& entry : log.entries()) {
        require_fields(log, entry, fields_of_a_line());
        const auto inner = [](const json& of, const char* name) {
            return of.is_object() ? of.value(name, json()) : json();
        };
        if (entry.content["action"] == "undo" &&
            !inner(inner(inner(entry.content, "parameters"), "step"), "line").is_number_integer())
            fail("{}:{}: does not say which line it undoes; take the log from a backup", log.path().string(),
                 entry.line);
    }
}

PendingStep::PendingStep(fs::path folder, const TreatmentLog& log)
    : folder_(std::move(folder)), held_(folder_ / kTreatmentLog) {
    log.require_unchanged();
    const fs::path pending = folder_ / kPending;
    clear_pending(pending);
    try {
        told_of(pending, log.path(), [&] { make_folder(pending); });
        told_of(pending / kStepFile, log.path(), [&] {
            write_text_file(pending / kStepFile, json_line(json{{"previous", log.head()}}) + "\n");
        });
    } catch (...) {
        std::error_code left;
        fs::remove_all(pending, left);
        throw;
    }
}

PendingStep::~PendingStep() {
    std::error_code left;
    if (!logged_) fs::remove_all(folder_ / kPending, left);
}

fs::path PendingStep::file(const std::string& path) const {
    TP_REQUIRE(stays_inside(path), "a step keeps its files in the treatment's folder");
    fs::path file = folder_ / kPending / path;
    make_folder(file.parent_path());
    return file;
}

void PendingStep::commit(TreatmentLog& log, json entry, const std::function<void()>& elsewhere) {
    // A disk that does not give their names, or has no room for their folders, does not before the line is
    // written.
    const std::vector<fs::path> files = files_of_step(folder_ / kPending);
    MadeFolders made;
    for (const fs::path& file : files) made.make((folder_ / file).parent_path());
    try {
        log.append(std::move(entry), held_, elsewhere);
        made.keep();
    } catch (...) {
        logged_ = !log.is_as_long_as_known();  // the line could not be taken back: the step goes with it
        throw;
    }
    logged_ = true;
    move_into_place(folder_, log.entries().back(), files);
}

}  // namespace tangi
