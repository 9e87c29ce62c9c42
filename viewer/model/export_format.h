// export_format.h: what the painting can be written as for other programs, as the window offers it.
#pragma once

namespace tangi {

struct ExportFormat {
    const char* name;    // in the menu
    const char* format;  // as `tangipaint export --to` has it
    const char* ending;  // of its file; empty: it is a folder
};

}  // namespace tangi
