#include "surface/tiff_pages.h"

#include <algorithm>
#include <fstream>
#include <set>
#include <string>

namespace tangi {

namespace {

constexpr std::size_t kMostPages = 4096, kMostEntries = 4096;  // of a file, of a page: beyond lies damage

// The file's bytes in its own order; BigTIFF has numbers of 8 bytes where TIFF has 4, and counts of 8 for 2.
class TiffBytes {
public:
    explicit TiffBytes(const std::filesystem::path& path) : stream_(path, std::ios::binary) {}

    // Where the first directory is; 0 where this is no TIFF file.
    std::uint64_t open() {
        std::string head(4, '\0');
        if (!stream_.read(head.data(), 4)) return 0;
        if (head.substr(0, 2) != "II" && head.substr(0, 2) != "MM") return 0;
        big_endian_ = head[0] == 'M';
        const std::uint64_t version = number(head.data() + 2, 2);
        if (version != 42 && version != 43) return 0;
        big_ = version == 43;
        return read(big_ ? 8 : 4, big_ ? 8 : 4).value_or(0);
    }

    std::optional<std::uint64_t> read(std::uint64_t at, std::size_t bytes) {
        char word[8] = {};
        stream_.clear();
        stream_.seekg(static_cast<std::streamoff>(at));
        if (!stream_.read(word, static_cast<std::streamsize>(bytes))) return {};
        return number(word, bytes);
    }
    bool is_big() const { return big_; }

private:
    std::uint64_t number(const char* word, std::size_t bytes) const {
        std::uint64_t result = 0;
        for (std::size_t i = 0; i < bytes; ++i)
            result = result << 8 | static_cast<unsigned char>(word[big_endian_ ? i : bytes - 1 - i]);
        return result;
    }

    std::ifstream stream_;
    bool big_endian_ = false, big_ = false;
};

struct Directory {
    TiffPage page;
    std::uint64_t next = 0;
    std::vector<std::uint64_t> below;  // SubIFDs
};

std::size_t bytes_of_type(std::uint64_t type) {
    switch (type) {
        case 3:
            return 2;  // SHORT
        case 4:
        case 13:
            return 4;  // LONG, IFD
        case 16:
        case 18:
            return 8;  // LONG8, IFD8
        default:
            return 0;
    }
}

// The numbers of an entry, a few at most.
std::vector<std::uint64_t> values_of(TiffBytes& bytes, std::uint64_t entry) {
    constexpr std::uint64_t most = 64;
    const std::size_t word = bytes.is_big() ? 8 : 4;
    const auto type = bytes.read(entry + 2, 2), count = bytes.read(entry + 4, word);
    const std::size_t size = type ? bytes_of_type(*type) : 0;
    if (!count || size == 0) return {};
    std::uint64_t at = entry + 4 + word;
    if (*count > word / size) at = bytes.read(at, word).value_or(0);
    std::vector<std::uint64_t> values;
    for (std::uint64_t i = 0; i < std::min(*count, most); ++i)
        if (const auto value = bytes.read(at + i * size, size)) values.push_back(*value);
    return values;
}

void take_entry(TiffBytes& bytes, std::uint64_t entry, Directory& directory) {
    constexpr std::uint64_t kNewSubfileType = 254, kSubfileType = 255, kWidth = 256, kHeight = 257,
                            kPhotometric = 262, kSamplesPerPixel = 277, kSubIfds = 330;
    const std::uint64_t tag = bytes.read(entry, 2).value_or(0);
    if (tag != kNewSubfileType && tag != kSubfileType && tag != kWidth && tag != kHeight &&
        tag != kPhotometric && tag != kSamplesPerPixel && tag != kSubIfds)
        return;
    std::vector<std::uint64_t> values = values_of(bytes, entry);
    if (values.empty()) return;
    TiffPage& page = directory.page;
    const std::uint64_t value = values.front();
    if (tag == kWidth) page.width = static_cast<std::uint32_t>(value);
    if (tag == kHeight) page.height = static_cast<std::uint32_t>(value);
    if (tag == kPhotometric) page.photometric = static_cast<int>(value);
    if (tag == kSamplesPerPixel) page.samples = static_cast<int>(value);
    if (tag == kNewSubfileType) page.reduced = (value & 1) != 0, page.is_mask = (value & 4) != 0;
    if (tag == kSubfileType) page.reduced = value == 2;
    if (tag == kSubIfds) directory.below = std::move(values);
}

std::optional<Directory> directory_at(TiffBytes& bytes, std::uint64_t at) {
    const std::size_t count_bytes = bytes.is_big() ? 8 : 2, entry_bytes = bytes.is_big() ? 20 : 12;
    const auto count = bytes.read(at, count_bytes);
    if (!count || *count == 0 || *count > kMostEntries) return {};
    Directory directory;
    const std::uint64_t first = at + count_bytes;
    for (std::uint64_t i = 0; i < *count; ++i) take_entry(bytes, first + i * entry_bytes, directory);
    directory.next = bytes.read(first + *count * entry_bytes, bytes.is_big() ? 8 : 4).value_or(0);
    return directory;
}

void choose(TiffPages& result) {
    const std::vector<TiffPage>& pages = result.pages;
    const bool any = std::any_of(pages.begin(), pages.end(),
                                 [](const TiffPage& page) { return !page.reduced && !page.is_mask; });
    const auto may_be = [&](const TiffPage& page) { return !any || (!page.reduced && !page.is_mask); };
    double most = -1;
    for (std::size_t i = 0; i < pages.size(); ++i)
        if (may_be(pages[i]) && pages[i].pixels() > most) most = pages[i].pixels(), result.chosen = i;
    const TiffPage& best = pages[result.chosen];
    result.alike =
        static_cast<std::size_t>(std::count_if(pages.begin(), pages.end(), [&](const TiffPage& page) {
            return may_be(page) && page.width == best.width && page.height == best.height;
        }));
}

}  // namespace

const TiffPage* TiffPages::larger_hidden() const {
    const TiffPage* largest = nullptr;
    for (const TiffPage& page : hidden)
        if (!page.is_mask && page.pixels() > picture().pixels() &&
            (!largest || page.pixels() > largest->pixels()))
            largest = &page;
    return largest;
}

std::optional<TiffPages> tiff_pages(const std::filesystem::path& path) {
    TiffBytes bytes(path);
    TiffPages result;
    std::set<std::uint64_t> seen;
    for (std::uint64_t at = bytes.open(); at != 0 && seen.insert(at).second && seen.size() <= kMostPages;) {
        const auto directory = directory_at(bytes, at);
        if (!directory) break;  // what comes before can still be read
        result.pages.push_back(directory->page);
        for (const std::uint64_t below : directory->below)
            if (below != 0 && seen.insert(below).second)
                if (const auto hidden = directory_at(bytes, below)) result.hidden.push_back(hidden->page);
        at = directory->next;
    }
    if (result.pages.empty()) return {};
    choose(result);
    return result;
}

}  // namespace tangi
