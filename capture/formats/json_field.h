// json_field.h: one value of a JSON file, named in messages as the user finds it there
// ("dome.directions[3].x").
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "surface/base/error.h"
#include "surface/base/json_text.h"

namespace tangi {

// Keeps references to the file's name and its JSON, which have to outlive it. Each accessor throws Error
// naming file and path where the value is missing or of another kind.
class JsonField {
public:
    JsonField(const std::string& file, const nlohmann::json& value, std::string path = {})
        : file_(file), value_(value), path_(std::move(path)) {}

    const std::string& file() const { return file_; }
    const std::string& path() const { return path_; }
    bool has(const char* key) const {
        return value_.is_object() && value_.contains(key) && !value_.at(key).is_null();
    }
    // A value that is null is there; is_null() takes it, to the others it is missing.
    JsonField operator[](const char* key) const {
        const std::string path = path_.empty() ? key : path_ + "." + key;
        if (!value_.is_object() || !value_.contains(key)) fail("{}: {} is missing", file_, path);
        return {file_, value_.at(key), path};
    }
    bool is_null() const { return value_.is_null(); }
    double number() const {
        if (!value_.is_number()) fail_as("not a number");
        return value_.get<double>();
    }
    double number(double minimum, double maximum) const {
        const double x = number();
        if (!(x >= minimum && x <= maximum))
            fail("{}: {} = {} is not in [{}, {}]", file_, path_, x, minimum, maximum);
        return x;
    }
    bool truth() const {
        if (!value_.is_boolean()) fail_as("neither true nor false");
        return value_.get<bool>();
    }
    std::string text() const {
        if (!value_.is_string()) fail_as("not a text");
        std::string text = value_.get<std::string>();
        if (text.size() > kMostOfText)
            fail("{}: {} is a text of {} bytes; {} at most", file_, path_, text.size(), kMostOfText);
        return text;
    }
    std::vector<JsonField> list() const {
        if (!value_.is_array()) fail_as("not a list");
        std::vector<JsonField> entries;
        for (std::size_t i = 0; i < value_.size(); ++i)
            entries.emplace_back(file_, value_[i], fmt::format("{}[{}]", path_, i));
        return entries;
    }
    bool is_list() const { return value_.is_array(); }

private:
    static constexpr std::size_t kMostOfText = 1000;  // [bytes] names of photographs have up to 255

    [[noreturn]] void fail_as(const char* what) const {
        fail("{}: {} is {}", file_, path_, is_null() ? "missing" : what);
    }

    const std::string& file_;
    const nlohmann::json& value_;
    std::string path_;
};

// The text of a JSON file. Throws Error naming the file, line and column of what is no JSON.
inline nlohmann::json json_in(const std::string& text, const std::string& file) {
    try {
        return parse_json(text, file);
    } catch (const nlohmann::json::parse_error& error) {
        const std::size_t end = std::min(error.byte > 0 ? error.byte - 1 : 0, text.size());
        const std::string before = text.substr(0, end);
        const auto line = 1 + std::count(before.begin(), before.end(), '\n');
        const auto newline = before.rfind('\n');
        const std::size_t column = before.size() - (newline == std::string::npos ? 0 : newline + 1) + 1;
        fail("{}, line {}, column {}: is no JSON from here on; is the file whole?", file, line, column);
    }
}

}  // namespace tangi
