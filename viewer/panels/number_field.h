// number_field.h: sliders and fields in which numbers are typed.
//
// Dear ImGui drops characters that it does not expect, so that "120,5" would become 1205, and takes "12 cm"
// for 12. Here what was typed is read as a whole (surface/base/typed_number.h) when the field is left: it is
// taken, or refused with words and the value stays. All numbers of the panels are typed here. The unit that
// the field shows, in its format ("%.1f mm") or in its label ("Width, mm"), may be typed behind the number.
#pragma once

#include <imgui.h>

#include <optional>
#include <string>

#include "surface/maps/surface.h"

namespace tangi::panels {

struct SlideOptions {
    bool logarithmic = false;
    double typed_high = 0;  // may be typed, where that is more than the slider's upper end
};
// A slider; Ctrl-click types into it. True where the value changed.
bool slide(const char* label, float& value, float low, float high, const char* format,
           const SlideOptions& options = {});
bool slide(const char* label, double& value, float low, float high, const char* format,
           const SlideOptions& options = {});
bool slide(const char* label, int& value, int low, int high, const char* format);
// Two beside each other, of one range.
bool slide_both(const char* label, float (&values)[2], float low, float high, const char* format);
// Two ends that are dragged, by so much a pixel; the first is never above the second.
bool drag_ends(const char* label, float& low, float& high, float speed, const char* format);

// A field. Values from `low` to `high` are taken.
bool type_number(const char* label, double& value, double low, double high, const char* format);
bool type_number(const char* label, float& value, double low, double high, const char* format);
// With buttons for one less and one more.
bool type_number(const char* label, int& value, int low, int high);

// A colour [sRGB], with its components from 0 to 255.
bool colour_field(const char* label, Rgb& srgb);

// Makes the next item so narrow that its label, which stands to the right of it, ends within the column.
void leave_room_for(const char* label);

// What was wrong with what was typed, once.
std::optional<std::string> number_complaint();

}  // namespace tangi::panels
