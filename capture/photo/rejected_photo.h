// rejected_photo.h: photographs that a stack goes on without, and how many of them it may lose.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "surface/base/error.h"

namespace tangi {

struct RejectedPhoto {
    std::string name;    // of the light, as its file has it, or of the photograph's file
    std::string reason;  // naming the file, the place and the remedy
};

// A photograph that cannot be read: missing, no picture, damaged. Whoever reads many can go on without it.
class PhotoError : public Error {
public:
    PhotoError(std::filesystem::path path, const std::string& message)
        : Error(message), path_(std::move(path)) {}
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

// As fail(), of a photograph; the message begins with its path.
template <class... Args>
[[noreturn]] void fail_photo(const std::filesystem::path& path, fmt::format_string<Args...> format,
                             Args&&... args) {
    throw PhotoError(path, path.string() + ": " + fmt::format(format, std::forward<Args>(args)...));
}

// Throws Error with the first reason where a third of `all` photographs or more is lost, or too few are left
// for what follows: somebody should look first. Nothing lost is fine however few there are.
void require_few(const std::vector<RejectedPhoto>& lost, std::size_t all, std::size_t least,
                 const std::string& what);

nlohmann::json to_json(const std::vector<RejectedPhoto>& rejected);

}  // namespace tangi
