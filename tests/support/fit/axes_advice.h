// axes_advice.h: what a message advises about the axes of lights, as one would type it.
#pragma once

#include <sstream>
#include <string>
#include <vector>

namespace tangi {

// The words of the last "give --light-axes … --light-rotation-deg …" of the text; none where it gives none.
inline std::vector<std::string> advised_flags(const std::string& text) {
    std::vector<std::string> flags;
    const auto at = text.rfind("give --light-");
    if (at == std::string::npos) return flags;
    std::istringstream words(text.substr(at + 5));
    for (std::string flag, value; words >> flag >> value && flag.starts_with("--light-");)
        flags.insert(flags.end(), {flag, value});
    return flags;
}

}  // namespace tangi
