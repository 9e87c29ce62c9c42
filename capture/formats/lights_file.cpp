#include "capture/formats/lights_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <optional>

#include "capture/formats/lights_text.h"
#include "surface/base/error.h"
#include "surface/base/words.h"
#include "surface/file/atomic_file.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

// Bytes of the printable letter that `text` begins with, in UTF-8 (RFC 3629, section 4); 0 where it begins
// with another byte.
std::size_t letter_length(std::string_view text) {
    const auto byte = [&](std::size_t i) {
        return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
    };
    const unsigned lead = byte(0);
    if (lead < 0x80) return lead >= 0x20 && lead != 0x7F ? 1 : 0;
    const std::size_t length = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
    unsigned code = lead & (0x7Fu >> length);
    for (std::size_t i = 1; i < length; ++i) {
        if ((byte(i) & 0xC0u) != 0x80) return 0;
        code = code << 6 | (byte(i) & 0x3Fu);
    }
    constexpr unsigned smallest[] = {0, 0, 0xA0, 0x800, 0x10000};  // U+0080 to U+009F control terminals
    const bool is_letter = lead >= 0xC2 && lead <= 0xF4 && code >= smallest[length] && code <= 0x10FFFF &&
                           !(code >= 0xD800 && code <= 0xDFFF);
    return is_letter ? length : 0;
}

// Cuts the last blank-separated word off `rest` and returns it.
std::string_view cut_last_word(std::string_view& rest) {
    rest = without_blanks(rest);
    const auto blank = rest.find_last_of(" \t");
    const std::string_view word = blank == std::string_view::npos ? rest : rest.substr(blank + 1);
    rest = blank == std::string_view::npos ? std::string_view() : without_blanks(rest.substr(0, blank));
    return word;
}

// Text of a file as messages show it: binary files may hold what upsets a terminal, and lines without end.
std::string in_message(std::string_view text) {
    constexpr std::size_t most = 60;
    std::string result;
    for (std::size_t i = 0; i < text.size() && result.size() < most;) {
        const std::size_t length = letter_length(text.substr(i));
        if (length > 0)
            result += text.substr(i, length);
        else
            result += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[i]));
        i += std::max<std::size_t>(length, 1);
        if (result.size() >= most && i < text.size()) result += "…";
    }
    return result;
}

// A number in the C locale; a decimal comma is read as a point. "nan" and "inf" are numbers here, so that the
// caller can say more than "not a number", and one that no double holds is infinite.
std::optional<double> number(std::string_view word) {
    std::string text(word);
    std::replace(text.begin(), text.end(), ',', '.');
    if (text.starts_with('+')) text.erase(0, 1);
    double value = 0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (end != text.data() + text.size() || status == std::errc::invalid_argument) return std::nullopt;
    if (status == std::errc::result_out_of_range)
        return text.find("e-") == std::string::npos && text.find("E-") == std::string::npos ? HUGE_VAL : 0.0;
    return value;
}

// Digits after the point; as many as any with an exponent.
int decimals_of(std::string_view word) {
    const std::size_t point = word.find_first_of(".,");
    if (word.find_first_of("eE") != std::string_view::npos) return std::numeric_limits<float>::digits10;
    return point == std::string_view::npos ? 0 : static_cast<int>(word.size() - point - 1);
}

std::optional<long> whole_number(std::string_view word) {
    long value = 0;
    const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (status != std::errc() || end != word.data() + word.size()) return std::nullopt;
    return value;
}

// The first bytes of JPEG, PNG, TIFF (and most camera raws) and OpenEXR.
bool begins_as_picture(std::string_view text) {
    using namespace std::string_view_literals;
    const std::string_view beginnings[] = {"\xFF\xD8\xFF"sv, "\x89PNG\r\n"sv, "II*\0"sv, "MM\0*"sv,
                                           "\x76\x2F\x31\x01"sv};
    return std::any_of(std::begin(beginnings), std::end(beginnings),
                       [&](std::string_view bytes) { return text.starts_with(bytes); });
}

// Whether it begins with what no text has. A zero further on is a damaged line, which alone is left out.
bool begins_as_binary(std::string_view text) {
    constexpr std::size_t beginning = 64;
    return text.substr(0, beginning).find('\0') != std::string_view::npos;
}

// Old programs for the Macintosh end lines with a carriage return alone.
std::string with_newlines(std::string text) {
    if (text.find('\n') == std::string::npos) std::replace(text.begin(), text.end(), '\r', '\n');
    return text;
}

// `name` is known where the line ends in three words, whatever they are.
Light parse_line(std::string_view line, const std::string& place, std::string& name, double& length,
                 int& decimals) {
    std::string_view rest = line;
    glm::dvec3 vector;
    std::string_view words[3];
    for (int i = 2; i >= 0; --i) words[i] = cut_last_word(rest);
    if (rest.size() > 2 && rest.front() == '"' && rest.back() == '"') rest = rest.substr(1, rest.size() - 2);
    name = rest;
    for (int i = 2; i >= 0; --i) {
        const std::string_view word = words[i];
        const auto value = number(word);
        if (!value) fail("{}: expected 'name x y z', but '{}' is not a number", place, in_message(word));
        if (std::isinf(*value) && word.find_first_of("0123456789") != std::string_view::npos)
            fail("{}: '{}' is out of range; only the light's direction counts, so give a smaller vector",
                 place, in_message(word));
        vector[i] = *value;
        decimals = std::max(decimals, decimals_of(word));
    }
    if (rest.empty()) fail("{}: expected 'name x y z', but the photograph's name is missing", place);
    if (!std::isfinite(vector.x) || !std::isfinite(vector.y) || !std::isfinite(vector.z))
        fail("{}: the light of '{}' is not finite; give a direction or remove the line", place,
             in_message(rest));
    const double largest = std::max({std::abs(vector.x), std::abs(vector.y), std::abs(vector.z)});
    if (!(largest > 1e-6))
        fail("{}: the light of '{}' is a zero vector; give a direction or remove the line", place,
             in_message(rest));
    length = largest * glm::length(vector / largest);  // squares of huge numbers would overflow
    return distant_light(Vec3(vector / largest), std::string(rest));
}

}  // namespace

namespace {

// Lines of a lights file that are put together.
class LineReader {
public:
    explicit LineReader(const std::string& file_name) : file_name_(file_name) {}

    void add(std::string_view line, int number) {
        ++lines_;
        const std::string place = fmt::format("{}, line {}", file_name_, number);
        std::string name;
        try {
            double length = 0;
            Light light = parse_line(line, place, name, length, result_.decimals);
            if (const auto earlier = line_of_.find(light.name); earlier != line_of_.end())
                return add_again(light, place, earlier->second);
            line_of_.emplace(light.name, number);
            numbers_.push_back(number);
            result_.lights.push_back(std::move(light));
            result_.lengths.push_back(length);
        } catch (const Error& error) {
            leave_out(name, error.what());
        }
    }

    LightsFile take(const std::optional<long>& count) {
        require_few(result_.rejected, lines_, 1, file_name_);
        decode();
        const std::size_t used = result_.lights.size();
        if (count && *count != static_cast<long>(lines_))
            result_.warnings.push_back(fmt::format(
                "{}: its first line says {} lights, but {} follow; {} are used", file_name_, *count, lines_,
                used == lines_ ? fmt::format("all {}", used) : std::to_string(used)));
        for (const RejectedPhoto& light : result_.rejected)
            result_.warnings.push_back(light.reason + "; its photograph is rejected");
        return std::move(result_);
    }

    std::vector<std::string>& warnings() { return result_.warnings; }
    std::size_t lines() const { return lines_; }

private:
    // What the vectors mean where they are none of directions.
    void decode() {
        std::vector<glm::dvec3> vectors;
        for (std::size_t i = 0; i < result_.lights.size(); ++i)
            vectors.push_back(glm::dvec3(result_.lights[i].direction) * result_.lengths[i]);
        std::string told = decode_vectors(vectors, file_name_);
        if (told.empty()) return;
        result_.warnings.push_back(std::move(told));
        for (std::size_t i = 0; i < vectors.size(); ++i) {
            result_.lights[i] = distant_light(Vec3(vectors[i]), result_.lights[i].name);
            result_.lengths[i] = 1;
        }
    }

    void leave_out(const std::string& name, const std::string& reason) {
        result_.rejected.push_back({name, reason});
    }

    // Which of two different lights is right, nobody knows.
    void add_again(const Light& light, const std::string& place, int earlier) {
        const std::string what =
            fmt::format("{}: '{}' has a light in line {} already", place, in_message(light.name), earlier);
        const auto at = std::find(numbers_.begin(), numbers_.end(), earlier);
        if (at == numbers_.end()) return leave_out(light.name, what);
        const auto index = at - numbers_.begin();
        if (glm::length(result_.lights[static_cast<std::size_t>(index)].direction - light.direction) <
            kSameDirection) {
            result_.warnings.push_back(what + ", the same; it is used once");
            return;
        }
        leave_out(light.name, what);
        numbers_.erase(at);
        result_.lights.erase(result_.lights.begin() + index);
        result_.lengths.erase(result_.lengths.begin() + index);
    }

    const std::string& file_name_;
    LightsFile result_;
    std::map<std::string, int> line_of_;
    std::vector<int> numbers_;  // lines of result_.lights
    std::size_t lines_ = 0;
};

}  // namespace

LightsFile parse_lights(const std::string& text, const std::string& file_name) {
    std::optional<long> count;
    if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
        fail("{}: is UTF-16 text; save it as UTF-8", file_name);
    if (begins_as_picture(text))
        fail("{}: is a picture, and no lights file (.lp); name the list of photographs and their lights",
             file_name);
    if (begins_as_binary(text))
        fail("{}: is no text, and so no lights file (.lp); name the list of photographs and their lights",
             file_name);
    LineReader reader(file_name);
    bool first = true;
    for (const LightsLine& line :
         lines_of_lights(with_newlines(text.starts_with("\xEF\xBB\xBF") ? text.substr(3) : text), file_name,
                         reader.warnings())) {
        if (first) {
            first = false;
            count = whole_number(line.text);
            if (count) continue;
            reader.warnings().push_back(
                fmt::format("{}: the first line is not a count of lights", file_name));
        }
        reader.add(line.text, line.number);
    }
    if (reader.lines() == 0)
        fail("{}: holds no lights; expected a count, then a line 'name x y z' for each photograph",
             file_name);
    return reader.take(count);
}

bool looks_like_lights(const std::string& text) {
    try {
        parse_lights(text, "");
        return true;
    } catch (const Error&) {
        return false;
    }
}

LightsFile read_lights_file(const fs::path& path) {
    if (!fs::exists(path)) fail("{}: no such lights file", path.string());
    if (fs::is_directory(path)) fail("{}: is a folder; name the lights file (.lp) in it", path.string());
    return parse_lights(read_text_file(path), path.string());
}

std::string lights_text(std::span<const Light> lights) {
    std::string text = fmt::format("{}\n", lights.size());
    for (const Light& light : lights)
        text += fmt::format("{} {:.6f} {:.6f} {:.6f}\n", light.name, light.direction.x, light.direction.y,
                            light.direction.z);
    return text;
}

void write_lights_file(const fs::path& path, std::span<const Light> lights) {
    write_text_file(path, lights_text(lights));
}

}  // namespace tangi
