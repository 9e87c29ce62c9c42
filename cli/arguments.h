// arguments.h: what several commands take: photographs, regions, lights, encodings.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "capture/stack/open_screened.h"
#include "cli/flags.h"
#include "paint/optics/spectrum.h"

namespace tangi {

// How photographs become linear light.
struct DevelopArguments {
    std::string dark, flat, ambient, brackets, demosaic = "AHD", raw_colour = "rec709";

    void add_to(Flags& flags);
    DevelopOptions options() const;
    std::vector<std::filesystem::path> inputs() const;  // the files that they name
    bool asks_anything() const {
        return !dark.empty() || !flat.empty() || !ambient.empty() || !brackets.empty();
    }
};

// Where photographs are and how to read them.
struct PhotosArguments {
    std::string folder, lights, capture, transfer = "auto", crop, mask, hold_out, registration = "auto";
    std::string light_axes = "x,y,z";
    bool lights_mm = false;
    double light_rotation_deg = 0;
    DevelopArguments develop;

    void add_to(Flags& flags, bool for_fit);
    // Without photographs that cannot be used (capture/stack/open_screened.h). Throws Error for what is wrong
    // with the folder, UsageError for what is wrong with the flags.
    UsableStack open() const;
    // The same, however many cannot be used.
    Stack open_any() const;
    LightAxes axes() const;
    // The files that a command with these flags reads: photographs, lights, mask, frames, brackets.
    std::vector<std::filesystem::path> inputs(const Stack& stack) const;
    // As they were given, for provenance; files relative to the folder.
    nlohmann::json as_json() const;

private:
    void add_light_flags(Flags& flags);
    void add_fit_flags(Flags& flags);
    StackOptions options() const;
    UsableOptions usable_options() const;
};

// Throws Error where `output` is a file that a treatment keeps, or would be: its log would no longer be true.
void refuse_in_treatment(const std::filesystem::path& output);
// Throws Error, naming the flag, where writing `output` would replace one of `inputs`: photographs
// cannot be taken again; and where a treatment keeps it.
void refuse_to_overwrite(const std::filesystem::path& output,
                         const std::vector<std::filesystem::path>& inputs, std::string_view flag = "--out");

// Throw UsageError naming the flag where a file to write is called as no file of its kind is. `what` says
// how they are: "a page is an .html file".
void require_ending(const std::string& file, std::initializer_list<std::string_view> endings,
                    std::string_view what, std::string_view flag = "--out");
void require_painting_ending(const std::string& file, std::string_view flag = "--out");  // .exr, .tangi
void require_picture_ending(const std::string& file, std::string_view flag = "--out");

// Throws UsageError where one of `flags` is among those that were `typed`, with the reason: what is typed has
// an effect or is refused, so that nobody takes a result for another one.
void refuse_typed(const std::vector<std::string>& typed, std::initializer_list<std::string_view> flags,
                  const std::string& reason);

// Throws Error where a folder that is there, or the one that `folder` would be made in, cannot be written.
void require_writable_folder(const std::filesystem::path& folder);

// "auto" as nothing, anything else as a curve. Throws UsageError naming the flag --transfer.
std::optional<Transfer> parse_transfer(const std::string& text);

// "1,2.5,3" as numbers. Throws UsageError naming the flag and what was expected, in the words of `form`: a
// word that is no number, or one too large.
std::vector<double> numbers_in(const std::string& text, const std::string& flag, const std::string& form);

// "1,0,0.5" as a unit vector, whatever its length. Throws UsageError naming the flag: no three numbers, or
// all zero.
Vec3 parse_direction(const std::string& text, const std::string& flag);
// The same, of a light that is in front of the painting: z > 0.
Vec3 parse_direction_in_front(const std::string& text, const std::string& flag);
Illuminant parse_illuminant(const std::string& word, const std::string& flag);

// "10,-20,300" as a place [mm] in front of the painting. Throws UsageError naming the flag: no three numbers,
// a place behind the painting's plane or in it, or one beyond 1 km.
Vec3 parse_position(const std::string& text, const std::string& flag);

// Prints the warnings, but for the first that were told before, and returns all as JSON.
nlohmann::json told(const std::vector<std::string>& warnings, std::size_t before = 0);

}  // namespace tangi
