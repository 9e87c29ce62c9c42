// storage_text.h: files as OpenCV's FileStorage writes them (XML and YAML), as far as lenses need them. Read
// by ourselves: OpenCV's own readers end the process where such a file is damaged.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tangi {

// What a file holds by name, and what those hold.
struct StorageNode {
    std::string name, text;  // the text of a value, or of the list of one
    std::vector<StorageNode> children;

    // The first of this name; null where there is none.
    const StorageNode* find(std::string_view wanted) const;
};

// `is_xml`: of the two forms. Throws Error naming the file (`where`) and the line where the text is neither,
// or values are in each other deeper than 16.
StorageNode parse_storage(std::string_view text, bool is_xml, const std::string& where);

struct StorageMatrix {
    int rows = 0, columns = 0;
    std::vector<double> values;  // row by row
};

// The matrix and the whole number of this name. Throw Error naming the file and the field where it is missing
// or makes no sense: numbers that are none or not finite, other than rows and columns say, more than 1000.
StorageMatrix matrix_in(const StorageNode& file, const char* name, const std::string& where);
int size_in(const StorageNode& file, const char* name, const std::string& where);

}  // namespace tangi
