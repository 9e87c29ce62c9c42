// painting_errors.h: what goes wrong in reading a painting file, in the words of its user.
#pragma once

#include <exception>
#include <filesystem>
#include <new>

#include "surface/base/error.h"
#include "surface/base/progress.h"

namespace tangi {

// What is wrong with the file, for what a library threw while it was read: that it is cut off, that its
// pixels or its header are damaged, or what the operating system said; and what to do. Throws Error.
[[noreturn]] void fail_reading(const std::filesystem::path& path, const std::exception& error);

// Throws Error where the file is too short for the pixels that its header speaks of: OpenEXR would ask for
// memory for them first; and where its end is missing, be it that of a part that the caller does not read.
void require_whole(const std::filesystem::path& path);

// Runs `body`, which reads the painting file at `path`; what it throws of OpenEXR becomes an Error that names
// the file, as does a path that is no file.
template <class Body>
auto reading_painting(const std::filesystem::path& path, const Body& body) {
    if (!std::filesystem::exists(path)) fail("{}: no such file", path.string());
    if (std::filesystem::is_directory(path)) fail("{}: is a folder, not a painting file", path.string());
    if (!std::filesystem::is_regular_file(path)) fail("{}: is a pipe or a device, not a file", path.string());
    require_whole(path);
    try {
        return body();
    } catch (const Error&) {
        throw;
    } catch (const Cancelled&) {
        throw;
    } catch (const std::bad_alloc&) {
        fail("{}: not enough memory to read it", path.string());
    } catch (const std::exception& error) {
        fail_reading(path, error);
    }
}

}  // namespace tangi
