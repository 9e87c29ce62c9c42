// test_support.h: what the tests share: folders that vanish, image comparison, the data beside the repository.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

#include "surface/error.h"
#include "surface/image.h"

namespace tangi {

// An empty folder that is removed with everything in it.
class TestDir {
public:
    TestDir() {
        std::string pattern = (std::filesystem::temp_directory_path() / "tangi-test-XXXXXX").string();
        path_ = ::mkdtemp(pattern.data());
    }
    ~TestDir() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TestDir(const TestDir&) = delete;
    TestDir& operator=(const TestDir&) = delete;

    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

private:
    std::filesystem::path path_;
};

// The message of the Error that `call` throws; fails the test where it throws none, or something else.
template <class Call>
std::string error_of(Call&& call) {
    try {
        call();
    } catch (const Error& error) {
        return error.what();
    } catch (const std::exception& other) {
        ADD_FAILURE() << "threw another exception than Error: " << other.what();
        return {};
    }
    ADD_FAILURE() << "threw no Error";
    return {};
}

// A folder of the data that is too large for the repository: $TANGIPAINT_DATA, or ../shared/data beside the source.
// Tests that need it begin with TP_DATA(path, "real/icon"), are named Data*, and are skipped, saying so, without it.
inline std::optional<std::filesystem::path> data_folder(const std::string& name) {
    const char* given = std::getenv("TANGIPAINT_DATA");
    const std::filesystem::path root =
        given ? std::filesystem::path(given) : std::filesystem::path(TP_SOURCE_DIR) / ".." / "shared" / "data";
    if (!std::filesystem::is_directory(root / name)) return std::nullopt;
    return root / name;
}

#define TP_DATA(variable, name)                                                                 \
    const auto variable##_found = ::tangi::data_folder(name);                                   \
    if (!variable##_found) GTEST_SKIP() << "skipped: the data folder '" << (name) << "' is not here"; \
    const std::filesystem::path variable = *variable##_found

}  // namespace tangi
