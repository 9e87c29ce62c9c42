// docs_pages.h: the pages of the documentation as text: headings, links, sentences, code, and the flags in
// it.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace tangi::docs {

using Names = std::vector<std::string>;
using Tree = std::map<std::string, std::string>;  // path from the root -> text

inline std::string text_of(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

// All pages (.md) of a folder and its subfolders, but for what is built or hidden.
inline Tree pages_of(const std::filesystem::path& root) {
    namespace fs = std::filesystem;
    Tree pages;
    for (fs::recursive_directory_iterator at(root), end; at != end; ++at) {
        const std::string name = at->path().filename().string();
        if (at->is_directory() && (name.front() == '.' || name == "build" || name == "out"))
            at.disable_recursion_pending();
        if (!at->is_regular_file() || at->path().extension() != ".md") continue;
        pages[fs::relative(at->path(), root).generic_string()] = text_of(at->path());
    }
    return pages;
}

inline std::string trimmed(const std::string& text) {
    const auto begin = text.find_first_not_of(" \t\r");
    return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

// A page in blocks: what is code (fenced or indented by four spaces), headings, table rows, and paragraphs,
// whose lines are joined. An item of a list is a paragraph. Equations, fenced as ```math or by $$, are none.
struct Blocks {
    Names code;        // line by line
    Names headings;    // without the #
    Names rows;        // of tables
    Names paragraphs;  // pictures that stand alone are paragraphs, too
};

inline Blocks blocks_of(const std::string& text) {
    static const std::regex item(R"(^([-*+]|\d+[.)])\s+)");
    Blocks blocks;
    std::string paragraph, fence;
    bool equation = false;
    const auto end_paragraph = [&] {
        if (!paragraph.empty()) blocks.paragraphs.push_back(paragraph);
        paragraph.clear();
    };
    std::istringstream lines(text);
    bool in_list = false;  // where four spaces are no code
    for (std::string line; std::getline(lines, line);) {
        std::string plain = trimmed(line);
        if (!fence.empty()) {
            if (plain == "```")
                fence.clear();
            else if (fence != "```math")
                blocks.code.push_back(plain);
            continue;
        }
        if (plain.starts_with("```")) {
            end_paragraph();
            fence = plain;
        } else if (equation || plain.starts_with("$$")) {
            end_paragraph();
            const bool closes = plain.ends_with("$$") && (equation || plain.size() > 3);
            equation = !closes;
        } else if (plain.empty()) {
            end_paragraph();
        } else if (line.starts_with("    ") && paragraph.empty() && !in_list) {
            blocks.code.push_back(plain);
        } else if (plain.front() == '#') {
            end_paragraph();
            in_list = false;
            blocks.headings.push_back(
                trimmed(plain.substr(std::min(plain.find_first_not_of('#'), plain.size()))));
        } else if (plain.front() == '|') {
            end_paragraph();
            blocks.rows.push_back(plain);
        } else {
            if (plain.front() == '>') plain = trimmed(plain.substr(1));
            std::smatch match;
            if (std::regex_search(plain, match, item)) {
                end_paragraph();
                in_list = true;
                plain = match.suffix();
            } else if (paragraph.empty() && line.front() != ' ') {
                in_list = false;
            }
            paragraph += (paragraph.empty() ? "" : " ") + plain;
        }
    }
    end_paragraph();
    return blocks;
}

// --- Headings and links.

// UTF-8 to code points; what is none is U+FFFD.
inline std::u32string code_points(const std::string& text) {
    std::u32string points;
    for (std::size_t i = 0; i < text.size();) {
        const auto lead = static_cast<unsigned char>(text[i]);
        const std::size_t length = lead < 0x80 ? 1 : lead < 0xe0 ? 2 : lead < 0xf0 ? 3 : 4;
        char32_t point = length == 1 ? lead : lead & (0xffu >> (length + 1));
        for (std::size_t k = 1; k < length && i + k < text.size(); ++k)
            point = (point << 6) | (static_cast<unsigned char>(text[i + k]) & 0x3fu);
        points.push_back(point);
        i += length;
    }
    return points;
}

// The anchor that GitHub gives to a heading: lower case, blanks to hyphens, no punctuation.
inline std::u32string anchor_of(const std::string& heading) {
    static const std::regex link(R"(\[([^\]]*)\]\([^)]*\))");
    std::u32string anchor;
    for (char32_t c : code_points(std::regex_replace(heading, link, "$1"))) {
        if (c == U' ')
            anchor.push_back(U'-');
        else if (c < 0x80) {
            if (std::isalnum(static_cast<int>(c)) || c == U'-' || c == U'_')
                anchor.push_back(static_cast<char32_t>(std::tolower(static_cast<int>(c))));
        } else if ((c >= 0xc0 && c <= 0xde && c != 0xd7) || (c >= 0x391 && c <= 0x3a9)) {
            anchor.push_back(c + 0x20);
        } else if (!(c >= 0xa0 && c <= 0xbf) && c != 0xd7 && c != 0xf7 && !(c >= 0x2000 && c < 0x2c00)) {
            anchor.push_back(c);
        }
    }
    return anchor;
}

inline std::set<std::u32string> anchors_of(const std::string& page) {
    std::set<std::u32string> anchors;
    for (const std::string& heading : blocks_of(page).headings) {
        const std::u32string anchor = anchor_of(heading);
        std::u32string unique = anchor;
        for (char32_t number = U'1'; anchors.contains(unique); ++number) unique = anchor + U'-' + number;
        anchors.insert(unique);
    }
    return anchors;
}

inline std::string without_code_spans(const std::string& text) {
    static const std::regex span(R"(`[^`]*`)");
    return std::regex_replace(text, span, "code");
}

struct Link {
    std::string target;
    bool picture = false;
};

// What stands outside of code, of paragraphs, tables and headings.
inline std::vector<Link> links_of(const std::string& page) {
    static const std::regex link(R"((!?)\[((?:[^\[\]]|\[[^\]]*\]\([^)]*\))*)\]\(([^)\s]+)[^)]*\))");
    std::vector<Link> links;
    const Blocks blocks = blocks_of(page);
    for (const Names* list : {&blocks.paragraphs, &blocks.rows, &blocks.headings})
        for (const std::string& text : *list) {
            const std::string plain = without_code_spans(text);
            for (std::sregex_iterator at(plain.begin(), plain.end(), link), end; at != end; ++at)
                links.push_back({(*at)[3], (*at)[1].length() > 0});
        }
    return links;
}

inline bool is_address(const std::string& target) {
    return target.starts_with("http:") || target.starts_with("https:") || target.starts_with("mailto:");
}

// The path from the root of what a link on a page leads to; the page itself for a bare anchor.
inline std::string path_of(const std::string& page, const std::string& target) {
    const std::string file = target.substr(0, target.find('#'));
    if (file.empty()) return page;
    return (std::filesystem::path(page).parent_path() / file).lexically_normal().generic_string();
}

// One line for each link to a file, or an anchor, that is not there.
template <class Exists>
Names broken_links(const Tree& pages, const Exists& exists) {
    Names broken;
    for (const auto& [page, text] : pages)
        for (const Link& link : links_of(text)) {
            if (is_address(link.target)) continue;
            const std::string path = path_of(page, link.target);
            const auto hash = link.target.find('#');
            const auto other = pages.find(path);
            if (other == pages.end() && !exists(path))
                broken.push_back(page + " links to " + link.target + ", which is not there");
            else if (hash != std::string::npos &&
                     (other == pages.end() ||
                      !anchors_of(other->second).contains(code_points(link.target.substr(hash + 1)))))
                broken.push_back(page + " links to " + link.target + ": " + path + " has no such heading");
        }
    return broken;
}

// One line for each picture that no page shows.
inline Names unused_pictures(const Tree& pages, const Names& pictures) {
    std::set<std::string> used;
    for (const auto& [page, text] : pages)
        for (const Link& link : links_of(text)) used.insert(path_of(page, link.target));
    Names unused;
    for (const std::string& picture : pictures)
        if (!used.contains(picture)) unused.push_back(picture + " is shown on no page");
    return unused;
}

// --- Prose.

// Words, links by their text; a piece of code is one word.
inline int words_in(const std::string& text) {
    static const std::regex link(R"(!?\[([^\]]*)\]\([^)]*\))");
    std::istringstream words(std::regex_replace(without_code_spans(text), link, "$1"));
    int count = 0;
    for (std::string word; words >> word;)
        count += std::any_of(word.begin(), word.end(), [](char c) {
            return std::isalnum(static_cast<unsigned char>(c)) || static_cast<unsigned char>(c) >= 0x80;
        });
    return count;
}

inline Names sentences_of(const std::string& paragraph) {
    static const std::regex end(R"([.!?][")\]*_]*\s+)");
    static const std::regex link(R"(!?\[([^\]]*)\]\([^)]*\))");
    const std::string text = std::regex_replace(without_code_spans(paragraph), link, "$1");
    Names sentences;
    std::string::const_iterator begin = text.begin();
    for (std::sregex_iterator at(text.begin(), text.end(), end), none; at != none; ++at) {
        sentences.emplace_back(begin, (*at)[0].second);
        begin = (*at)[0].second;
    }
    sentences.emplace_back(begin, text.end());
    std::erase_if(sentences, [](const std::string& s) { return words_in(s) == 0; });
    return sentences;
}

struct ProseLimits {
    double mean = 20;
    int sentence = 45, paragraph = 120;  // words
};

// One line for each sentence and paragraph of a page that is too long, and for sentences that are on average.
inline Names long_prose(const std::string& page, const std::string& text, const ProseLimits& limits = {}) {
    Names violations;
    int words = 0, sentences = 0;
    for (const std::string& paragraph : blocks_of(text).paragraphs) {
        if (paragraph.starts_with("![")) continue;
        if (const int length = words_in(paragraph); length > limits.paragraph)
            violations.push_back(page + ": a paragraph of " + std::to_string(length) +
                                 " words: " + paragraph.substr(0, 60));
        for (const std::string& sentence : sentences_of(paragraph)) {
            const int length = words_in(sentence);
            words += length;
            ++sentences;
            if (length > limits.sentence)
                violations.push_back(page + ": a sentence of " + std::to_string(length) +
                                     " words: " + sentence.substr(0, 60));
        }
    }
    if (sentences > 0 && words > limits.mean * sentences)
        violations.push_back(page + ": " + std::to_string(words / sentences) + " words a sentence");
    return violations;
}

// --- Flags.

// command -> its flags with the --
using Flags = std::map<std::string, std::set<std::string>>;

inline std::set<std::string> flags_in(const std::string& text) {
    static const std::regex flag(R"((^|[^A-Za-z0-9_/-])(--[a-z0-9][a-z0-9_-]*))");
    std::set<std::string> flags;
    for (std::sregex_iterator at(text.begin(), text.end(), flag), end; at != end; ++at)
        flags.insert((*at)[2]);
    return flags;
}

// Flags in the first column of what `tangipaint COMMAND --help` prints.
inline std::set<std::string> flags_of_help(const std::string& help) {
    std::set<std::string> flags;
    std::istringstream lines(help);
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with("  -")) continue;
        const auto gap = line.find("  ", 2);
        flags.merge(flags_in(line.substr(0, gap)));
    }
    flags.erase("--help");
    return flags;
}

// Names in the section "Subcommands" of what `tangipaint --help` prints.
inline Names commands_of_help(const std::string& help) {
    Names commands;
    std::istringstream lines(help);
    bool inside = false;
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("Subcommands"))
            inside = true;
        else if (inside && line.starts_with("  ") && line.size() > 2 && line[2] != ' ')
            commands.push_back(line.substr(2, line.find(' ', 2) - 2));
    }
    return commands;
}

// The part of a page below a heading of the second level.
inline std::string section_of(const std::string& page, const std::string& heading) {
    const std::string title = "\n## " + heading + "\n";
    const auto begin = page.find(title);
    if (begin == std::string::npos) return "";
    const auto end = page.find("\n## ", begin + title.size());
    return page.substr(begin, end == std::string::npos ? end : end - begin);
}

// Pieces of code on a page: spans, and lines of blocks. Comments of a shell are not part of them.
inline Names code_of(const std::string& page) {
    static const std::regex span(R"(`([^`]*)`)");
    const Blocks blocks = blocks_of(page);
    Names code;
    for (std::string line : blocks.code) code.push_back(line.substr(0, line.find(" #")));
    for (const Names* list : {&blocks.paragraphs, &blocks.rows, &blocks.headings})
        for (const std::string& text : *list)
            for (std::sregex_iterator at(text.begin(), text.end(), span), end; at != end; ++at)
                code.push_back((*at)[1]);
    return code;
}

// One line for each flag that a page gives to a command which has none such. A piece of code counts that
// calls tangipaint, begins with the name of a command, or with a flag; that of other programs does not.
inline Names unknown_flags(const std::string& page, const std::string& text, const Flags& known) {
    std::set<std::string> all = {"--help", "--version"};
    for (const auto& [command, flags] : known) all.insert(flags.begin(), flags.end());
    // Of scripts and of other programs, where they stand alone.
    const std::set<std::string> foreign = {"--preset",       "--sanitize", "--figures", "--benchmark_filter",
                                           "--gtest_filter", "--config",   "--unlock"};
    Names violations;
    for (const std::string& code : code_of(text)) {
        std::istringstream words(code);
        std::string first, command;
        words >> first;
        if (first == "tangipaint" || first.ends_with("/tangipaint"))
            words >> command;
        else if (known.contains(first))
            command = first;
        else if (!first.starts_with("--"))
            continue;
        const auto of_command = known.find(command);
        for (const std::string& flag : flags_in(code)) {
            if (flag == "--help" || foreign.contains(flag)) continue;
            const bool is_known =
                of_command == known.end() ? all.contains(flag) : of_command->second.contains(flag);
            if (!is_known)
                violations.push_back(page + ": " + (command.empty() ? "no command" : command) + " has no " +
                                     flag + ": " + code.substr(0, 60));
        }
    }
    return violations;
}

// One line for each flag of the program that the page of commands lacks, in the section of its command, and
// for each there that the program does not have.
inline Names undocumented_flags(const std::string& commands_page, const Flags& known) {
    Names violations;
    for (const auto& [command, flags] : known) {
        const std::string section = section_of(commands_page, command);
        if (section.empty()) violations.push_back("no section about " + command);
        std::set<std::string> listed;
        for (const std::string& row : blocks_of(section).rows) {
            const auto cell = row.find('|', 1);
            listed.merge(flags_in(row.substr(0, cell)));
        }
        for (const std::string& flag : flags)
            if (!listed.contains(flag)) violations.push_back(command + " lacks " + flag);
        for (const std::string& flag : listed)
            if (!flags.contains(flag))
                violations.push_back(command + " lists " + flag + ", which it has not");
    }
    return violations;
}

}  // namespace tangi::docs
