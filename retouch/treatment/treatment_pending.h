// treatment_pending.h: a step of a treatment while it is written (treatment_folder.h).
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "retouch/treatment/treatment_log.h"

namespace tangi {

inline constexpr const char* kPending = "pending";  // in the treatment's folder

// Holds the log, so that no other program writes, and what the step makes in pending/. Destroyed without
// commit(), it removes that, and the treatment is what it was.
class PendingStep {
public:
    // Throws Error where another program wrote to the log since it was opened.
    PendingStep(std::filesystem::path folder, const TreatmentLog& log);
    ~PendingStep();
    PendingStep(const PendingStep&) = delete;
    PendingStep& operator=(const PendingStep&) = delete;

    // Where to write what shall be `path` in the folder.
    std::filesystem::path file(const std::string& path) const;
    // Writes the line, which makes the step done, and puts its files in their places. Throws Error: where the
    // line cannot be written, or `elsewhere` throws (TreatmentStep), the step has not happened; where a file
    // cannot be put in its place, it has, and the next command finishes it.
    void commit(TreatmentLog& log, nlohmann::json entry, const std::function<void()>& elsewhere = {});

private:
    std::filesystem::path folder_;
    LogHold held_;
    bool logged_ = false;
};

// Whether a path, relative to a folder, leads to something in it.
bool stays_inside(const std::string& path);

}  // namespace tangi
