// bagit.h: bags for archives (BagIt 1.0, RFC 8493): files with their SHA-256, so that in decades it can be
// told whether they are still the same.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "surface/base/progress.h"

namespace tangi {

using BagInfo = std::vector<std::pair<std::string, std::string>>;  // lines of bag-info.txt: label, value

struct BagReport {
    std::size_t files = 0;
    std::uint64_t bytes = 0;
    std::vector<std::string> faults;  // of a check: in words, each with its file
};

// Fills a folder with bagit.txt, bag-info.txt (Payload-Oxum, Bagging-Date and Bag-Software-Agent are added),
// manifest-sha256.txt, tagmanifest-sha256.txt and data/, into which files and folders are copied under their
// own names. Hidden files in folders are left out. Throws Error naming the file: one that cannot be read, two
// of one name; Cancelled.
BagReport fill_bag(const std::filesystem::path& folder, const std::vector<std::filesystem::path>& files,
                   const BagInfo& info, const Progress& progress = {});

// Compares all files with the manifests: missing, changed, in no manifest, another number of bytes. Throws
// Error where the folder is no bag that can be read.
BagReport check_bag(const std::filesystem::path& folder, const Progress& progress = {});

}  // namespace tangi
