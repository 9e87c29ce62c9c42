// typed_number.h: a number as people type it, with a decimal point or a decimal comma.
//
// Everywhere that one number is typed, in the window and on the command line: "120,5" is 120.5. What can be
// read in two ways is refused with words, never guessed.
#pragma once

#include <string>
#include <string_view>

namespace tangi {

struct TypedNumber {
    double value = 0;
    bool comma = false;     // it has a decimal comma
    std::string complaint;  // why it is none, and what to type; else empty
    // With a decimal point: "120.5"; empty where it is none.
    std::string plain;
};

// `unit`: what may stand behind it, as "mm" or "mm²" (which is "mm2"); any other unit is refused, too.
// Blanks, points, commas and apostrophes between thousands are refused, and so is "1,234", which may be 1.234
// or 1234
// ("0,125" and "1.234" may not: the program itself writes points).
TypedNumber typed_number(std::string_view text, std::string_view unit = {});

}  // namespace tangi
