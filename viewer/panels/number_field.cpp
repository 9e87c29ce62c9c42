#include "viewer/panels/number_field.h"

#include <fmt/format.h>
#include <imgui_internal.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "surface/base/typed_number.h"

namespace tangi::panels {

namespace {

// The field that is typed into; there is one keyboard.
struct Typing {
    ImGuiID id = 0;
    std::array<char, 64> text{};
    std::array<char, 64> begun{};  // what it held: where it is left so, the value stays, with all its digits
};
Typing typing;

std::optional<std::string> complaint;

// "ΔE %.0f mm" in its parts: "%.0f" and what stands behind it.
struct NumberFormat {
    std::string conversion = "%.3f", unit;
};

NumberFormat parts_of(const char* format) {
    NumberFormat parts;
    const std::string text = format;
    const auto begin = text.find('%');
    if (begin == std::string::npos) return parts;
    const auto end = text.find_first_of("fgd", begin);
    if (end == std::string::npos) return parts;
    parts.conversion = text.substr(begin, end - begin + 1);
    parts.unit = text.substr(end + 1);
    return parts;
}

void write_into(std::array<char, 64>& text, const NumberFormat& format, double value) {
    // The formats are the panels' own.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
    if (format.conversion.back() == 'd')
        std::snprintf(text.data(), text.size(), format.conversion.c_str(), static_cast<int>(value));
    else
        std::snprintf(text.data(), text.size(), format.conversion.c_str(), value);
#pragma GCC diagnostic pop
}

// "##by" and "Fit###Fit" are for Dear ImGui.
std::string shown_label(const char* label) {
    const std::string text = label;
    return text.substr(0, text.find("##"));
}

// The unit that stands in the format, "%.1f mm", or behind a comma in the label, "Width, mm".
std::string unit_of(const char* label, const NumberFormat& format) {
    const std::string shown = shown_label(label);
    const auto comma = shown.rfind(", ");
    return !format.unit.empty() || comma == std::string::npos ? format.unit : shown.substr(comma + 2);
}

// What was typed into the field that is left, where it is another number than before.
std::optional<double> typed_value(const char* label, const NumberFormat& format, double low, double high) {
    const Typing left = std::exchange(typing, {});
    if (left.text == left.begun) return {};
    const TypedNumber number = typed_number(left.text.data(), unit_of(label, format));
    const std::string name = shown_label(label), before = name.empty() ? "" : name + ": ";
    if (!number.complaint.empty()) {
        complaint = before + number.complaint;
        return {};
    }
    if (!(number.value >= low && number.value <= high)) {
        complaint = fmt::format("{}{} is not between {:.6g} and {:.6g}", before, number.plain, low, high);
        return {};
    }
    return number.value;
}

// Where Dear ImGui's slider or drag is typed into, a field of ours in its place; what was entered, once.
std::optional<double> typed_in_place(const char* label, ImGuiID id, const NumberFormat& format, double low,
                                     double high) {
    const ImGuiStyle& style = ImGui::GetStyle();
    const ImGuiWindow* window = ImGui::GetCurrentWindow();
    const ImVec2 text = ImGui::CalcTextSize(label, nullptr, true), at = window->DC.CursorPos;
    const float beside = text.x > 0 ? style.ItemInnerSpacing.x + text.x : 0;
    const ImRect frame(at, {at.x + ImGui::CalcItemWidth(), at.y + text.y + 2 * style.FramePadding.y});
    const ImRect all(frame.Min, {frame.Max.x + beside, frame.Max.y});
    ImGui::ItemSize(all, style.FramePadding.y);
    if (!ImGui::ItemAdd(all, id, &frame, ImGuiItemFlags_Inputable)) return {};
    ImGui::TempInputText(frame, id, label, typing.text.data(), static_cast<int>(typing.text.size()),
                         static_cast<int>(ImGuiInputTextFlags_AutoSelectAll) |
                             static_cast<int>(ImGuiInputTextFlags_NoMarkEdited));
    if (ImGui::GetActiveID() == id) return {};
    return typed_value(label, format, low, high);
}

// `draw` is Dear ImGui's own slider or drag of `value`.
template <class T, class Draw>
bool typed_or(const char* label, T& value, double low, double high, const char* format, const Draw& draw) {
    leave_room_for(label);
    const ImGuiID id = ImGui::GetID(label);
    const NumberFormat parts = parts_of(format);
    std::optional<double> entered;
    if (typing.id == id && ImGui::TempInputIsActive(id)) {
        entered = typed_in_place(label, id, parts, low, high);
    } else {
        if (typing.id == id) entered = typed_value(label, parts, low, high);  // it was left for another one
        const T before = value;
        const bool changed = draw();
        if (ImGui::TempInputIsActive(id)) {  // from now on it is typed into
            value = before;
            typing = {.id = id};
            write_into(typing.text, parts, static_cast<double>(value));
            typing.begun = typing.text;
        } else if (changed) {
            return true;
        }
    }
    if (!entered) return false;
    value = static_cast<T>(*entered);
    return true;
}

template <class T>
bool field(const char* label, T& value, double low, double high, const char* format) {
    const ImGuiID id = ImGui::GetID(label);
    const NumberFormat parts = parts_of(format);
    const bool ours = typing.id == id;
    Typing now{.id = id};
    if (ours) {
        now = typing;
    } else {
        write_into(now.text, {format, ""}, static_cast<double>(value));
        now.begun = now.text;
    }
    ImGui::InputText(label, now.text.data(), now.text.size(), ImGuiInputTextFlags_AutoSelectAll);
    if (ImGui::IsItemActive()) {
        typing = now;
        return false;
    }
    if (!ours) return false;
    typing = now;
    const std::optional<double> entered = typed_value(label, parts, low, high);
    if (!entered) return false;
    value = static_cast<T>(*entered);
    return true;
}

ImGuiSliderFlags flags_of(const SlideOptions& options) {
    return options.logarithmic ? ImGuiSliderFlags_Logarithmic : 0;
}

std::optional<int> whole(double value, const char* label) {
    if (value == std::round(value)) return static_cast<int>(value);
    complaint = fmt::format("{}: {:.6g} is no whole number", shown_label(label), value);
    return {};
}

}  // namespace

void leave_room_for(const char* label) {
    constexpr float kNarrowest_px = 40;
    const float beside = ImGui::CalcTextSize(label, nullptr, true).x + ImGui::GetStyle().ItemInnerSpacing.x;
    const float most = ImGui::GetContentRegionAvail().x - beside;
    if (ImGui::CalcItemWidth() > most) ImGui::SetNextItemWidth(std::max(most, kNarrowest_px));
}

std::optional<std::string> number_complaint() { return std::exchange(complaint, {}); }

bool slide(const char* label, float& value, float low, float high, const char* format,
           const SlideOptions& options) {
    return typed_or(label, value, static_cast<double>(low),
                    std::max(static_cast<double>(high), options.typed_high), format,
                    [&] { return ImGui::SliderFloat(label, &value, low, high, format, flags_of(options)); });
}

bool slide(const char* label, double& value, float low, float high, const char* format,
           const SlideOptions& options) {
    const double lowest = static_cast<double>(low), highest = static_cast<double>(high);
    return typed_or(label, value, lowest, std::max(highest, options.typed_high), format, [&] {
        return ImGui::SliderScalar(label, ImGuiDataType_Double, &value, &lowest, &highest, format,
                                   flags_of(options));
    });
}

bool slide(const char* label, int& value, int low, int high, const char* format) {
    double typed = value;
    int slid = value;
    const bool changed = typed_or(label, typed, low, high, format, [&] {
        if (!ImGui::SliderInt(label, &slid, low, high, format)) return false;
        typed = slid;
        return true;
    });
    const std::optional<int> taken = changed ? whole(typed, label) : std::nullopt;
    if (taken) value = *taken;
    return taken.has_value();
}

bool slide_both(const char* label, float (&values)[2], float low, float high, const char* format) {
    ImGui::BeginGroup();
    ImGui::PushID(label);
    ImGui::PushMultiItemsWidths(2, ImGui::CalcItemWidth());
    bool changed = slide("##first", values[0], low, high, format);
    ImGui::PopItemWidth();
    ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
    changed |= slide("##second", values[1], low, high, format);
    ImGui::PopItemWidth();
    ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
    ImGui::TextUnformatted(shown_label(label).c_str());
    ImGui::PopID();
    ImGui::EndGroup();
    return changed;
}

bool drag_ends(const char* label, float& low, float& high, float speed, const char* format) {
    constexpr float kMost = 1e6f;  // heights of no painting
    ImGui::BeginGroup();
    ImGui::PushID(label);
    ImGui::PushMultiItemsWidths(2, ImGui::CalcItemWidth());
    bool changed = typed_or("##low", low, static_cast<double>(-kMost), static_cast<double>(high), format,
                            [&] { return ImGui::DragFloat("##low", &low, speed, -kMost, high, format); });
    ImGui::PopItemWidth();
    ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
    changed |= typed_or("##high", high, static_cast<double>(low), static_cast<double>(kMost), format,
                        [&] { return ImGui::DragFloat("##high", &high, speed, low, kMost, format); });
    ImGui::PopItemWidth();
    ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
    ImGui::TextUnformatted(shown_label(label).c_str());
    ImGui::PopID();
    ImGui::EndGroup();
    return changed;
}

bool type_number(const char* label, double& value, double low, double high, const char* format) {
    return field(label, value, low, high, format);
}

bool type_number(const char* label, float& value, double low, double high, const char* format) {
    return field(label, value, low, high, format);
}

bool type_number(const char* label, int& value, int low, int high) {
    const float button = ImGui::GetFrameHeight(), gap = ImGui::GetStyle().ItemInnerSpacing.x;
    const int before = value;
    ImGui::BeginGroup();
    ImGui::PushID(label);
    ImGui::SetNextItemWidth(std::max(ImGui::CalcItemWidth() - 2 * (button + gap), 1.0f));
    double typed = value;
    if (field("##typed", typed, low, high, "%.0f"))
        if (const auto taken = whole(typed, label)) value = *taken;
    ImGui::SameLine(0, gap);
    if (ImGui::Button("-", {button, button})) value = std::max(value, low + 1) - 1;
    ImGui::SameLine(0, gap);
    if (ImGui::Button("+", {button, button})) value = std::min(value, high - 1) + 1;
    ImGui::SameLine(0, gap);
    ImGui::TextUnformatted(shown_label(label).c_str());
    ImGui::PopID();
    ImGui::EndGroup();
    return value != before;
}

bool colour_field(const char* label, Rgb& srgb) {
    bool changed = false;
    ImGui::PushID(label);
    const float side = ImGui::GetFrameHeight();
    if (ImGui::ColorButton("##colour", {srgb.r, srgb.g, srgb.b, 1}, ImGuiColorEditFlags_NoTooltip,
                           {side, side}))
        ImGui::OpenPopup("choose");
    ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
    ImGui::TextUnformatted(shown_label(label).c_str());
    if (ImGui::BeginPopup("choose")) {
        ImGui::SetNextItemWidth(12 * ImGui::GetFontSize());
        changed |= ImGui::ColorPicker3("##picker", &srgb.x,
                                       ImGuiColorEditFlags_NoInputs | ImGuiColorEditFlags_NoSidePreview |
                                           ImGuiColorEditFlags_NoLabel | ImGuiColorEditFlags_NoOptions);
        for (const auto& [name, channel] : {std::pair("R", 0), {"G", 1}, {"B", 2}}) {
            float value = 255 * srgb[channel];
            ImGui::SetNextItemWidth(12 * ImGui::GetFontSize());
            if (!slide(name, value, 0, 255, "%.0f")) continue;
            srgb[channel] = value / 255;
            changed = true;
        }
        ImGui::EndPopup();
    }
    ImGui::PopID();
    return changed;
}

}  // namespace tangi::panels
