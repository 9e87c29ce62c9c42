// painting_errors.h: what goes wrong in reading a painting file, in the words of its user.
#pragma once

#include <exception>
#include <filesystem>
#include <new>

#include "surface/error.h"
#include "surface/progress.h"

namespace tangi {

// Runs `body`, which reads the painting file at `path`; what it throws of OpenEXR or the JSON reader becomes
// an Error that names the file, as does a path that is no file.
template <class Body>
auto reading_painting(const std::filesystem::path& path, const Body& body) {
    if (!std::filesystem::exists(path)) fail("{}: no such file", path.string());
    if (std::filesystem::is_directory(path)) fail("{}: is a folder, not a painting file", path.string());
    if (!std::filesystem::is_regular_file(path)) fail("{}: is a pipe or a device, not a file", path.string());
    try {
        return body();
    } catch (const Error&) {
        throw;
    } catch (const Cancelled&) {
        throw;
    } catch (const std::bad_alloc&) {
        fail("{}: not enough memory to read it", path.string());
    } catch (const std::exception& error) {
        fail("{}: is not a painting file, or is damaged: {}", path.string(), error.what());
    }
}

}  // namespace tangi
