#include "capture/formats/storage_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "surface/base/error.h"
#include "surface/base/json_text.h"
#include "surface/base/words.h"

namespace tangi {

namespace {

constexpr std::size_t kDeepest = 16;
constexpr int kMostNumbers = 1000;  // lenses have 14 at most

// Names in each other, from the file on.
class Nest {
public:
    Nest(std::string_view text, const std::string& where) : text_(text), where_(where) {
        open_.push_back({});
    }

    StorageNode& innermost() { return open_.back(); }
    std::size_t depth() const { return open_.size() - 1; }
    void open(std::string_view name, std::size_t at) {
        if (open_.size() > kDeepest) wrong(at, "has values in each other, deeper than 16");
        open_.push_back({std::string(name), {}, {}});
    }
    void close() {
        StorageNode done = std::move(open_.back());
        open_.pop_back();
        open_.back().children.push_back(std::move(done));
    }
    StorageNode whole() {
        while (depth() > 0) close();
        return std::move(open_.front());
    }
    [[noreturn]] void wrong(std::size_t at, const char* what) const {
        fail("{}: line {}: {}; is it a calibration file of OpenCV, and whole?", where_, line_of(text_, at),
             what);
    }

private:
    std::string_view text_;
    const std::string& where_;
    std::vector<StorageNode> open_;
};

StorageNode parse_xml(std::string_view text, const std::string& where) {
    Nest nest(text, where);
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t tag = text.find('<', at);
        nest.innermost().text += text.substr(at, tag - at);
        if (tag == std::string_view::npos) break;
        const bool is_comment = text.substr(tag).starts_with("<!--");
        const std::size_t end = is_comment ? text.find("-->", tag) : text.find('>', tag);
        if (end == std::string_view::npos) nest.wrong(tag, "a tag does not end");
        at = end + (is_comment ? 3 : 1);
        if (is_comment || text[tag + 1] == '?') continue;
        const std::string_view inside = text.substr(tag + 1, end - tag - 1);
        if (inside.find('<') != std::string_view::npos) nest.wrong(tag, "a tag does not end");
        const bool closes = inside.starts_with('/');
        const std::string_view name =
            inside.substr(closes, inside.find_first_of(" \t\r\n/", closes) - closes);
        if (name.empty()) nest.wrong(tag, "a tag has no name");
        if (closes && (nest.depth() == 0 || nest.innermost().name != name))
            nest.wrong(tag, "a tag ends that did not begin");
        if (!closes) nest.open(name, tag);
        if (closes || inside.ends_with('/')) nest.close();
    }
    if (nest.depth() > 0) nest.wrong(text.size(), "it ends within a value");
    const StorageNode whole = nest.whole();
    const StorageNode* root = whole.find("opencv_storage");
    return root ? *root : whole;
}

// YAML as OpenCV writes it: a name and its value a line, those that belong to a name further right, lists in
// [ ].
StorageNode parse_yaml(std::string_view text, const std::string& where) {
    Nest nest(text, where);
    std::vector<std::size_t> indents;  // of those that are open
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t begin = at, end = std::min(text.find('\n', at), text.size());
        at = end + 1;
        std::string_view line = text.substr(begin, end - begin);
        line = line.substr(0, line.find('#'));
        const std::size_t indent = std::min(line.find_first_not_of(' '), line.size());
        line = without_blanks(line);
        if (line.empty() || line.starts_with("%YAML") || line.starts_with("---") || line == "...") continue;
        if (line[0] == '-') continue;  // an entry of a list, of which lenses have none
        const std::size_t colon = line.find(':');
        if (colon == std::string_view::npos || colon == 0 || line[0] == '[')
            nest.wrong(begin, "is not a name and its value");
        while (!indents.empty() && indents.back() >= indent) {
            nest.close();
            indents.pop_back();
        }
        nest.open(without_blanks(line.substr(0, colon)), begin);
        indents.push_back(indent);
        std::string_view value = without_blanks(line.substr(colon + 1));
        if (value.starts_with("!!"))
            value = without_blanks(value.substr(std::min(value.find(' '), value.size())));
        if (value.starts_with('[')) {  // over several lines, perhaps
            const std::size_t open = text.find('[', begin), close = text.find(']', open);
            if (close == std::string_view::npos) nest.wrong(begin, "a list does not end");
            value = text.substr(open + 1, close - open - 1);
            at = std::min(text.find('\n', close), text.size() - 1) + 1;
        }
        nest.innermost().text = value;
    }
    return nest.whole();
}

std::string unquoted(std::string_view text) {
    text = without_blanks(text);
    if (text.size() > 1 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
    return std::string(text);
}

std::optional<double> number_of(std::string_view word) {
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0;
    const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (status != std::errc() || end != word.data() + word.size()) return {};
    return value;
}

std::vector<double> numbers_of(std::string_view text, const std::string& what) {
    constexpr std::string_view between = " \t\r\n,";
    std::vector<double> numbers;
    for (std::size_t at = text.find_first_not_of(between); at != std::string_view::npos;) {
        const std::size_t end = std::min(text.find_first_of(between, at), text.size());
        const std::string_view word = text.substr(at, end - at);
        const auto number = number_of(word);
        if (!number && word.substr(1).starts_with("Nan")) fail("{} has a number that is not finite", what);
        if ((number && !std::isfinite(*number)) || word.find("Inf") != std::string_view::npos)
            fail("{} has a number that is not finite", what);
        if (!number) fail("{}: '{}' is no number", what, shortened(word, 40));
        if (numbers.size() >= std::size_t(kMostNumbers))
            fail("{} has more than {} numbers", what, kMostNumbers);
        numbers.push_back(*number);
        at = text.find_first_not_of(between, end);
    }
    return numbers;
}

}  // namespace

const StorageNode* StorageNode::find(std::string_view wanted) const {
    const auto found =
        std::ranges::find_if(children, [&](const StorageNode& child) { return child.name == wanted; });
    return found == children.end() ? nullptr : &*found;
}

StorageNode parse_storage(std::string_view text, bool is_xml, const std::string& where) {
    if (text.find('\0') != std::string_view::npos)
        fail("{}: line {}: a byte 0, which no text has; is it a calibration file of OpenCV, and whole?",
             where, line_of(text, text.find('\0')));
    return is_xml ? parse_xml(text, where) : parse_yaml(text, where);
}

int size_in(const StorageNode& file, const char* name, const std::string& where) {
    const StorageNode* node = file.find(name);
    const auto size = node ? number_of(unquoted(node->text)) : std::nullopt;
    constexpr double largest = 1e6;
    if (!size || !(*size >= 1 && *size <= largest) || *size != std::floor(*size))
        fail("{}: has no {}, or it is not a whole positive number", where, name);
    return static_cast<int>(*size);
}

StorageMatrix matrix_in(const StorageNode& file, const char* name, const std::string& where) {
    const StorageNode* node = file.find(name);
    if (!node) fail("{}: has no {}; is it a calibration file of OpenCV, and whole?", where, name);
    const StorageNode *kind = node->find("dt"), *data = node->find("data");
    const bool one_number = kind && unquoted(kind->text).size() == 1 &&
                            std::string_view("ucwsifd").find(unquoted(kind->text)) != std::string_view::npos;
    if (!one_number || !data) fail("{}: {} is no matrix of numbers", where, name);
    const std::string what = fmt::format("{}: {}", where, name);
    StorageMatrix matrix{size_in(*node, "rows", what), size_in(*node, "cols", what),
                         numbers_of(data->text, what)};
    if (static_cast<double>(matrix.rows) * matrix.columns != static_cast<double>(matrix.values.size()))
        fail("{}: is {} x {} by its rows and cols, and has {} numbers", what, matrix.rows, matrix.columns,
             matrix.values.size());
    return matrix;
}

}  // namespace tangi
