// arguments.h: what several commands take: photographs, regions, lights, encodings.
#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "capture/stack.h"

namespace tangi {

// Where photographs are and how to read them.
struct PhotosArguments {
    std::string folder, lights, transfer = "auto", crop, mask, hold_out;

    void add_to(CLI::App& app, bool for_fit);
    // Throws Error for what is wrong with the folder, UsageError for what is wrong with the flags.
    Stack open() const;
};

// "1,0,0.5" as three numbers. Throws UsageError naming the flag.
Vec3 parse_vector(const std::string& text, const std::string& flag);

// Prints the warnings and returns them as JSON.
nlohmann::json told(const std::vector<std::string>& warnings);

}  // namespace tangi
