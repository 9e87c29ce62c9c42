#include "fit/steps/block_file.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <fstream>

#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"
#include "surface/file/file_bytes.h"
#include "surface/file/sha256.h"
#include "surface/file/version.h"

namespace tangi {

namespace {

static_assert(std::endian::native == std::endian::little, "files are little-endian");
constexpr std::string_view kBegins = "tangipaint blocks 1\n";

[[noreturn]] void fail_damaged(const std::filesystem::path& path, const std::string& why) {
    fail("{}: {}; remove it and run the step that made it again", path.string(), why);
}

}  // namespace

void BlocksToWrite::write(const nlohmann::json& of, AtomicFile& file) const {
    Sha256 sum;
    nlohmann::json blocks = nlohmann::json::array();
    for (const Block& block : blocks_) {
        sum.add(block.bytes.data(), block.bytes.size());
        blocks.push_back({{"name", block.name}, {"bytes", block.bytes.size()}});
    }
    const std::string head =
        std::string(kBegins) +
        json_line({{"software", program_name()}, {"of", of}, {"blocks", blocks}, {"sha256", sum.hex()}}) +
        "\n";
    std::ofstream out(file.temporary(), std::ios::binary | std::ios::trunc);
    out.write(head.data(), static_cast<std::streamsize>(head.size()));
    for (const Block& block : blocks_)
        out.write(reinterpret_cast<const char*>(block.bytes.data()),
                  static_cast<std::streamsize>(block.bytes.size()));
    out.flush();
    if (!out)
        fail("{}: cannot be written: the disk is full, or gone; make room and run again",
             file.target().string());
}

BlockFile::BlockFile(std::filesystem::path path) : path_(std::move(path)) {
    const FileBytes file(path_);
    std::string all = file.bytes(0, file.size());
    const std::size_t end = all.starts_with(kBegins) ? all.find('\n', kBegins.size()) : std::string::npos;
    if (end == std::string::npos) fail_damaged(path_, "is no file of blocks, or is cut off");
    const nlohmann::json head =
        json_or_discarded(std::string_view(all).substr(kBegins.size(), end - kBegins.size()));
    try {
        of_ = head.at("of");
        sha256_ = head.at("sha256").get<std::string>();
        std::size_t at = 0;
        for (const nlohmann::json& block : head.at("blocks")) {
            blocks_.push_back(
                {block.at("name").get<std::string>(), at, block.at("bytes").get<std::size_t>()});
            at += blocks_.back().bytes;
        }
        bytes_ = all.substr(end + 1);
        if (bytes_.size() != at) fail_damaged(path_, "is cut off");
    } catch (const nlohmann::json::exception&) {
        fail_damaged(path_, "its first lines are damaged");
    }
    if (sha256_of(bytes_) != sha256_) fail_damaged(path_, "is damaged: its checksum is another one");
}

const BlockFile::Block* BlockFile::find(const std::string& name) const {
    const auto found = std::ranges::find(blocks_, name, &Block::name);
    return found == blocks_.end() ? nullptr : &*found;
}

std::size_t BlockFile::bytes_of(const std::string& name) const {
    const Block* block = find(name);
    if (!block) fail_damaged(path_, fmt::format("has no \"{}\"", name));
    return block->bytes;
}

void BlockFile::copy_bytes(const std::string& name, std::span<std::byte> values) const {
    if (bytes_of(name) != values.size()) fail_damaged(path_, fmt::format("\"{}\" has another size", name));
    if (!values.empty()) std::memcpy(values.data(), bytes_.data() + find(name)->begin, values.size());
}

}  // namespace tangi
