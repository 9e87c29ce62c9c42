#include "viewer/panels/fonts.h"

#include <backends/imgui_impl_opengl3.h>
#include <fontconfig/fontconfig.h>
#include <imgui.h>
#include <imgui_freetype.h>
#include <imgui_internal.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

namespace tangi {

namespace {

struct FontFile {
    std::string file;
    int face = 0;
    std::set<unsigned> has;  // of those that were asked for
};

// A typeface, or what comes nearest to it and has this character (0: any).
std::optional<FontFile> font_file(const char* family, unsigned character, const std::set<unsigned>& wanted) {
    const std::unique_ptr<FcPattern, void (*)(FcPattern*)> pattern(FcPatternCreate(), &FcPatternDestroy);
    const std::unique_ptr<FcCharSet, void (*)(FcCharSet*)> characters(FcCharSetCreate(), &FcCharSetDestroy);
    FcPatternAddString(pattern.get(), FC_FAMILY, reinterpret_cast<const FcChar8*>(family));
    FcPatternAddInteger(pattern.get(), FC_WEIGHT, FC_WEIGHT_REGULAR);
    FcPatternAddInteger(pattern.get(), FC_SLANT, FC_SLANT_ROMAN);
    FcPatternAddBool(pattern.get(), FC_SCALABLE, FcTrue);
    FcPatternAddBool(pattern.get(), FC_COLOR, FcFalse);  // pictures in place of outlines
    if (character != 0) {
        FcCharSetAddChar(characters.get(), character);
        FcPatternAddCharSet(pattern.get(), FC_CHARSET, characters.get());
    }
    FcConfigSubstitute(nullptr, pattern.get(), FcMatchPattern);
    FcDefaultSubstitute(pattern.get());
    FcResult result = FcResultNoMatch;
    const std::unique_ptr<FcPattern, void (*)(FcPattern*)> found(FcFontMatch(nullptr, pattern.get(), &result),
                                                                 &FcPatternDestroy);
    FcChar8* file = nullptr;
    if (!found || FcPatternGetString(found.get(), FC_FILE, 0, &file) != FcResultMatch) return {};
    FontFile font{reinterpret_cast<const char*>(file), 0, {}};
    if (std::error_code gone; !std::filesystem::is_regular_file(font.file, gone)) return {};
    FcPatternGetInteger(found.get(), FC_INDEX, 0, &font.face);
    font.face &= 0xffff;  // above, the instance of a variable font
    FcCharSet* has = nullptr;
    if (FcPatternGetCharSet(found.get(), FC_CHARSET, 0, &has) == FcResultMatch)
        for (const unsigned one : wanted)
            if (FcCharSetHasChar(has, one)) font.has.insert(one);
    return font;
}

// Latin, Greek and Cyrillic, for the names of files, and the signs of our own texts: there from the start.
constexpr ImWchar kGlyphs[] = {0x20,   0x17f,  0x370,  0x3ff,  0x400,  0x45f,  0x2010, 0x2033, 0x2070,
                               0x2094, 0x2190, 0x2199, 0x2202, 0x221e, 0x2248, 0x2265, 0};

constexpr const char* kFamily = "DejaVu Sans";

}  // namespace

PanelFonts::PanelFonts(float scale) : scale_(scale) {
    if (const auto found = font_file(kFamily, 0, {})) first_ = found->file;
    build();
}

void PanelFonts::need_character(unsigned character) {
    if (character < 0x80 || character > IM_UNICODE_CODEPOINT_MAX || !asked_.insert(character).second) return;
    if (!has(character)) missing_.insert(character);
}

void PanelFonts::need(std::string_view text) {
    const char* at = text.data();
    const char* const end = at + text.size();
    while (at < end) {
        if (static_cast<unsigned char>(*at) < 0x80) {
            ++at;
            continue;
        }
        unsigned character = 0;
        at += ImTextCharFromUtf8(&character, at, end);
        need_character(character);
    }
}

void PanelFonts::need_typed() {
    const ImGuiInputTextState& typed = ImGui::GetCurrentContext()->InputTextState;
    if (typed.ID == 0) return;
    for (int i = 0; i < typed.CurLenW; ++i) need_character(typed.TextW[i]);
}

bool PanelFonts::has(unsigned character) const {
    const ImFont* font = ImGui::GetIO().Fonts->Fonts[0];
    return font->FindGlyphNoFallback(static_cast<ImWchar>(character)) != nullptr;
}

bool PanelFonts::complete() {
    if (missing_.empty()) return false;
    const std::size_t before = further_.size();
    while (!missing_.empty()) {
        const unsigned character = *missing_.begin();
        const auto found = font_file(kFamily, character, missing_);
        missing_.erase(character);  // in none: it stays a question mark
        if (!found || !found->has.contains(character)) continue;
        Further& font = further_.emplace_back(Further{found->file, found->face, {}});
        for (const unsigned one : found->has) {
            font.ranges.insert(font.ranges.end(), 2, static_cast<unsigned short>(one));
            missing_.erase(one);
        }
        font.ranges.push_back(0);
    }
    if (further_.size() == before) return false;
    build();
    return true;
}

void PanelFonts::build() {
    ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
    const bool on_device = atlas.TexID != nullptr;             // which building forgets
    while (!fill() && !further_.empty()) further_.pop_back();  // a font that cannot be read
    if (!on_device) return;                                    // the device will ask for it
    ImGui_ImplOpenGL3_DestroyFontsTexture();
    ImGui_ImplOpenGL3_CreateFontsTexture();
}

bool PanelFonts::fill() const {
    ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
    atlas.Clear();
    ImFontConfig config;
    if (first_.empty()) {
        config.SizePixels = std::floor(13 * scale_);
        atlas.AddFontDefault(&config);
    } else {
        atlas.FontBuilderIO = ImGuiFreeType::GetBuilderForFreeType();
        atlas.FontBuilderFlags = ImGuiFreeTypeBuilderFlags_LightHinting;
        atlas.AddFontFromFileTTF(first_.c_str(), std::floor(15 * scale_), &config, kGlyphs);
    }
    for (const Further& font : further_) {
        ImFontConfig merged;
        merged.MergeMode = true;
        merged.FontNo = font.face;
        atlas.AddFontFromFileTTF(font.file.c_str(), std::floor(15 * scale_), &merged, font.ranges.data());
    }
    return atlas.Build();
}

}  // namespace tangi
