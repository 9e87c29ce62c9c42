// page_parts.h: where the parts of a page go (tiles, the map of horizons): into the page, or into files
// beside it.
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <string>

#include "surface/file/atomic_file.h"
#include "surface/file/atomic_folder.h"

namespace tangi {

class PageParts {
public:
    virtual ~PageParts() = default;
    // From any thread. `name`: LEVEL/COLUMN_ROW or horizon, of a further state in stateN/. Returns how many
    // bytes it takes as it is sent.
    virtual std::size_t add(const std::string& name, const std::string& bytes) = 0;
};

// <script type="text/plain"> is not run and not shown: text that the page looks up by its id.
class PartsInside : public PageParts {
public:
    PartsInside(std::filesystem::path page, double largest_mb)
        : page_(std::move(page)), largest_mb_(largest_mb) {}
    // Throws Error where the page becomes larger than it may be.
    std::size_t add(const std::string& name, const std::string& bytes) override;
    std::string text() const;  // in the order of their names, whatever thread was first

private:
    std::filesystem::path page_;
    double largest_mb_;
    std::mutex mutex_;
    std::map<std::string, std::string> elements_;
    std::size_t size_ = 0;
};

// parts/<name>.js, each a call with its name and its bytes; in a hidden folder until they are placed.
class PartsBeside : public PageParts {
public:
    // Throws Error where the folder holds an index.html, or something in parts/, that no export wrote: they
    // would be replaced. Other things may lie beside them.
    explicit PartsBeside(std::filesystem::path folder);
    ~PartsBeside() override;
    std::size_t add(const std::string& name, const std::string& bytes) override;
    // The old parts are gone once the new ones are there, with the page that wants them. Throws Error as the
    // constructor does.
    void place_with(AtomicFile& page);

private:
    std::filesystem::path folder_, hidden_;
    MadeFolders made_;
    bool left_ = false;
};

}  // namespace tangi
