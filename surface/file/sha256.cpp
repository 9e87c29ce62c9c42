#include "surface/file/sha256.h"

#include <openssl/evp.h>

#include <array>
#include <fstream>
#include <vector>

#include "surface/base/error.h"
#include "surface/file/file_bytes.h"

namespace tangi {

struct Sha256::State {
    EVP_MD_CTX* context = EVP_MD_CTX_new();
    ~State() { EVP_MD_CTX_free(context); }
};

Sha256::Sha256() : state_(std::make_unique<State>()) {
    TP_REQUIRE(state_->context && EVP_DigestInit_ex(state_->context, EVP_sha256(), nullptr) == 1,
               "OpenSSL has SHA-256");
}

Sha256::~Sha256() = default;

void Sha256::add(const void* bytes, std::size_t count) {
    TP_REQUIRE(EVP_DigestUpdate(state_->context, bytes, count) == 1, "a hash that has ended takes no more");
}

std::string Sha256::hex() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned size = 0;
    TP_REQUIRE(EVP_DigestFinal_ex(state_->context, digest.data(), &size) == 1, "a hash ends once");
    std::string text;
    for (unsigned i = 0; i < size; ++i) text += fmt::format("{:02x}", digest[i]);
    return text;
}

std::string sha256_of(std::string_view text) {
    Sha256 sha;
    sha.add(text);
    return sha.hex();
}

std::string sha256_of_file(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    if (!stream || std::filesystem::is_directory(path))
        fail("{}: cannot be read: {}", path.string(),
             trouble_reading(path).value_or("is it there, and may you read it?"));
    Sha256 sha;
    std::vector<char> buffer(1 << 20);
    while (stream) {
        stream.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
        sha.add(buffer.data(), static_cast<std::size_t>(stream.gcount()));
    }
    if (stream.bad())
        fail("{}: cannot be read to its end: {}", path.string(), trouble_reading(path).value_or("try again"));
    return sha.hex();
}

}  // namespace tangi
