#include "viewer/web/page_parts.h"

#include <fmt/format.h>

#include <regex>

#include "surface/base/error.h"
#include "surface/file/base64.h"
#include "surface/file/output_set.h"
#include "surface/file/stale_temporaries.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr const char* kCall = "tangiPart";  // what a part calls: of all pages, and of no other program's

// A page that is no page of ours, or what in a folder is no part of one; empty where there is none.
fs::path not_exported(const fs::path& folder) {
    const fs::path page = folder / "index.html", parts = folder / "parts";
    if (fs::exists(page) &&
        (!fs::is_regular_file(page) || read_text_file(page).find(kCall) == std::string::npos))
        return page;
    if (!fs::exists(parts)) return {};
    if (!fs::is_directory(parts)) return parts;
    static const std::regex own(R"((state\d+/)?(\d+/\d+_\d+|horizon)\.js)");
    for (const auto& entry : fs::recursive_directory_iterator(parts)) {
        if (entry.is_directory() || entry.path().filename().string().starts_with('.')) continue;
        if (!std::regex_match(entry.path().lexically_relative(parts).generic_string(), own))
            return entry.path();
    }
    return {};
}

void require_own(const fs::path& folder) {
    if (const fs::path other = not_exported(folder); !other.empty())
        fail("{}: is not of an earlier export, and would be replaced; name another folder, or move it away",
             other.string());
}

}  // namespace

std::size_t PartsInside::add(const std::string& name, const std::string& bytes) {
    const std::string element =
        fmt::format("<script type=\"text/plain\" id=\"part-{}\">{}</script>\n", name, base64(bytes));
    const std::lock_guard lock(mutex_);
    elements_[name] = element;
    size_ += element.size();
    if (static_cast<double>(size_) > 1e6 * largest_mb_)
        fail(
            "{}: the painting takes more than {} MB, too much for a page of one file; name a folder, from "
            "which browsers fetch what they show, or raise --largest-page-mb",
            page_.string(), largest_mb_);
    return element.size();
}

std::string PartsInside::text() const {
    std::string all;
    for (const auto& [name, element] : elements_) all += element;
    return all;
}

PartsBeside::PartsBeside(fs::path folder)
    : folder_(std::move(folder)), hidden_(folder_ / temporary_name("parts", "")) {
    require_own(folder_);
    made_.make(folder_);
    tidy_folder(folder_);
    make_folder(hidden_);
}

PartsBeside::~PartsBeside() {
    std::error_code ignored;
    if (!left_) fs::remove_all(hidden_, ignored);
}

std::size_t PartsBeside::add(const std::string& name, const std::string& bytes) {
    const fs::path path = hidden_ / (name + ".js");
    const std::string text = fmt::format("{}('{}','{}');\n", kCall, name, base64(bytes));
    make_folder(path.parent_path());
    told_of(hidden_, folder_ / "parts", [&] { write_text_file(path, text); });
    return text.size();
}

void PartsBeside::place_with(AtomicFile& page) {
    require_own(folder_);  // still
    OutputSet set;
    set.add_folder(hidden_, folder_ / "parts", [&](bool cleaned) {
        made_.keep();
        left_ = !cleaned;
    });
    set.add(page);
    set.commit();
}

}  // namespace tangi
