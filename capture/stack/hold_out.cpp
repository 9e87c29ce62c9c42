#include <optional>
#include <sstream>

#include "capture/stack/stack.h"
#include "surface/base/error.h"

namespace tangi {

void hold_out(Stack& stack, const std::string& which) {
    if (stack.photos.empty()) fail("--hold-out {}: {} has no photographs", which, stack.folder.string());
    std::vector<bool> held(stack.photos.size(), false);
    const auto hold = [&](const std::string& word, const auto& is_meant, const char* remedy = "") {
        bool any = false;
        for (std::size_t i = 0; i < held.size(); ++i)
            if (is_meant(stack.photos[i])) held[i] = any = true;
        if (!any)
            fail("--hold-out {}: there is no photograph {}; {} has photographs {} to {}{}", which, word,
                 stack.folder.string(), stack.photos.front().number, stack.photos.back().number, remedy);
    };
    const auto number = [](const std::string& text) -> std::optional<int> {
        if (text.empty() || text.size() > 9 || text.find_first_not_of("0123456789") != std::string::npos)
            return std::nullopt;
        return std::stoi(text);
    };
    std::istringstream words(which);
    for (std::string word; std::getline(words, word, ',');) {
        word.erase(0, word.find_first_not_of(" \t"));  // "0, 3"
        word.erase(word.find_last_not_of(" \t") + 1);
        const auto colon = word.find(':');
        const auto start = number(word.substr(0, colon));
        if (colon != std::string::npos && start) {
            const auto step = number(word.substr(colon + 1));
            if (!step || *step == 0)
                fail("--hold-out {}: '{}' is not START:STEP with a step of at least 1", which, word);
            hold(word, [&](const StackPhoto& photo) {
                return photo.number >= *start && (photo.number - *start) % *step == 0;
            });
        } else if (start) {
            hold(word, [&](const StackPhoto& photo) { return photo.number == *start; });
        } else {
            hold(
                word,
                [&](const StackPhoto& photo) {
                    return photo.light.name == word || photo.path.filename().string() == word;
                },
                "; give such numbers, names, or START:STEP for every STEPth from START on");
        }
    }
    std::vector<StackPhoto> kept;
    for (std::size_t i = 0; i < held.size(); ++i)
        (held[i] ? stack.held_out : kept).push_back(stack.photos[i]);
    stack.photos = std::move(kept);
}

}  // namespace tangi
