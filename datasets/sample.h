// sample.h: where the embedded sample lies: datasets/impasto, photographs of a rendered painting with its
// truth.
#pragma once

#include <filesystem>

namespace tangi {

// The folder that holds impasto/: $TANGIPAINT_DATASETS, else share/tangipaint/datasets below the prefix that
// program or library are installed to, else datasets/ of the source. Throws Error that says what to do where
// it is not there.
std::filesystem::path sample_folder();

}  // namespace tangi
