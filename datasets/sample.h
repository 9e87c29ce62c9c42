// sample.h: where the embedded sample lies: datasets/impasto, photographs of a rendered painting with its
// truth.
#pragma once

#include <filesystem>

namespace tangi {

// The folder that holds impasto/: $TANGIPAINT_DATASETS, else datasets/ of the source that this was built
// from. Throws Error that says what to do where it is not there.
std::filesystem::path sample_folder();

}  // namespace tangi
