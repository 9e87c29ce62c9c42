// named_tests.h: the tests that pages name, and those that there are.
#pragma once

#include <algorithm>
#include <regex>
#include <set>
#include <string>

#include "tests/docs/docs_pages.h"

namespace tangi::docs {

// What a file of tests holds, as gtest names it.
inline std::set<std::string> tests_in(const std::string& source) {
    static const std::regex test(R"(\bTEST(?:_[FP])?\(\s*(\w+),\s*(\w+)\))");
    std::set<std::string> found;
    for (std::sregex_iterator at(source.begin(), source.end(), test), end; at != end; ++at)
        found.insert((*at)[1].str() + "." + (*at)[2].str());
    return found;
}

// Tests that pages name, whole or by how they begin (`Suite.Begins*`), and that are not among
// `tests`.
inline Names missing_tests(const Tree& pages, const std::set<std::string>& tests) {
    static const std::regex name(R"(\b([A-Z]\w+\.[A-Z]\w+)(\*?))");
    Names missing;
    for (const auto& [page, text] : pages)
        for (std::sregex_iterator at(text.begin(), text.end(), name), end; at != end; ++at) {
            const std::string test = (*at)[1];
            const auto first = tests.lower_bound(test);
            const bool there =
                first != tests.end() && ((*at)[2].length() > 0 ? first->starts_with(test) : *first == test);
            // IMG_0001.CR2 is a file.
            const bool is_test =
                std::any_of(test.begin(), test.end(), [](char c) { return c >= 'a' && c <= 'z'; });
            if (is_test && !there) missing.push_back(page + ": " + test + " is no test");
        }
    return missing;
}

}  // namespace tangi::docs
