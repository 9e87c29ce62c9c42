// sha256.h: SHA-256 (FIPS 180-4, through OpenSSL), as 64 hex digits: what the log of a treatment is chained
// by.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace tangi {

class Sha256 {
public:
    Sha256();
    ~Sha256();
    Sha256(const Sha256&) = delete;
    Sha256& operator=(const Sha256&) = delete;

    void add(const void* bytes, std::size_t count);
    void add(std::string_view text) { add(text.data(), text.size()); }
    // Ends it: nothing can be added afterwards.
    std::string hex();

private:
    struct State;
    std::unique_ptr<State> state_;
};

std::string sha256_of(std::string_view text);

// Throws Error naming the file where it cannot be read.
std::string sha256_of_file(const std::filesystem::path& path);

}  // namespace tangi
