// fonts.h: the typefaces of the panels.
//
// Names of files and people, notes and logs may hold any script. Dear ImGui (1.86) draws what its atlas has:
// what is missing is sought in the other fonts of the machine (fontconfig) when it is to be shown first, and
// the atlas made anew.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace tangi {

class PanelFonts {
public:
    // DejaVu Sans, `scale` times as large as usual; where there is no font at all, the small one of Dear
    // ImGui.
    explicit PanelFonts(float scale);

    // This is to be shown, in UTF-8. Beyond the Basic Multilingual Plane, Dear ImGui shows nothing.
    void need(std::string_view text);
    void need_typed();  // what is in the field that is typed into

    // Between two frames: finds what is needed and missing. True where the atlas was made anew.
    bool complete();

private:
    struct Further {
        std::string file;
        int face = 0;                        // of those in the file
        std::vector<unsigned short> ranges;  // pairs of ends, and 0
    };
    void need_character(unsigned character);
    bool has(unsigned character) const;
    void build();       // the atlas, and the device's texture of it where there is one
    bool fill() const;  // the atlas, of all typefaces; false where one of them cannot be read

    float scale_;
    std::string first_;             // the file; empty: there is none
    std::set<unsigned> asked_;      // whatever came of it
    std::set<unsigned> missing_;    // asked for since complete()
    std::vector<Further> further_;  // beside the first one
};

}  // namespace tangi
