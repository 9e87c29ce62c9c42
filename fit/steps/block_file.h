// block_file.h: named arrays of numbers in one file, with what they are of and a checksum: what one step of a
// long work leaves to the next.
//
//   tangipaint blocks 1
//   {"of": …, "blocks": [{"name", "bytes"}, …], "sha256": of the bytes}    on one line
//   bytes, array after array
//
// Numbers are as this machine has them, little-endian; read by the version that wrote them.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace tangi {

class AtomicFile;

class BlocksToWrite {
public:
    // Refers to the values, which must live until they are written.
    template <class T>
    void add(std::string name, std::span<const T> values) {
        static_assert(std::is_trivially_copyable_v<T>);
        blocks_.push_back({std::move(name), std::as_bytes(values)});
    }
    // Fills the file, but does not commit it. Throws Error as AtomicFile::write().
    void write(const nlohmann::json& of, AtomicFile& file) const;

private:
    struct Block {
        std::string name;
        std::span<const std::byte> bytes;
    };
    std::vector<Block> blocks_;
};

class BlockFile {
public:
    // Reads all of it. Throws Error naming the file: it is not there, no such file, cut off, or its checksum
    // is another one.
    explicit BlockFile(std::filesystem::path path);

    const nlohmann::json& of() const { return of_; }
    const std::string& sha256() const { return sha256_; }

    bool has(const std::string& name) const { return find(name) != nullptr; }
    // Throws Error naming file and array: it is missing, or has another length than the values.
    template <class T>
    void copy(const std::string& name, std::span<T> values) const {
        static_assert(std::is_trivially_copyable_v<T>);
        copy_bytes(name, std::as_writable_bytes(values));
    }
    // The same of whatever length it has.
    template <class T>
    std::vector<T> get(const std::string& name) const {
        std::vector<T> values(bytes_of(name) / sizeof(T));
        copy(name, std::span<T>(values));
        return values;
    }

private:
    struct Block {
        std::string name;
        std::size_t begin, bytes;
    };
    const Block* find(const std::string& name) const;
    std::size_t bytes_of(const std::string& name) const;
    void copy_bytes(const std::string& name, std::span<std::byte> values) const;

    std::filesystem::path path_;
    nlohmann::json of_;
    std::string sha256_, bytes_;
    std::vector<Block> blocks_;
};

}  // namespace tangi
