// further_faults_test.cpp: the other commands that write, and other ways to call those of
// faults_test.cpp; see fault_scene.h.
#include "tests/robustness/fault_scene.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;

const Words kLoss = {"--polygon", "-2,-2;2,-2;2,2"};

Words with_loss(Words command) {
    command.insert(command.end(), kLoss.begin(), kLoss.end());
    return command;
}

const Words kBegun = {"treatment", "begin", "T", "--painting", "p.exr"}, kFilled = with_loss({"fill", "T"}),
            kRetouched = with_loss({"retouch", "--treatment", "T"}), kChecked = {"treatment", "check", "T"},
            kSeen = {"info", "p.exr"};

class CliFurtherFaults : public CliFaults {
protected:
    CliFurtherFaults() {
        Image<Rgb> mask(24, 24);
        for (int y = 9; y < 15; ++y)
            for (int x = 9; x < 15; ++x) mask(x, y) = Rgb(1);
        write_picture_8bit(given() / "m.png", mask);
    }

    // A command whose output is there from another call of it, or is not.
    void try_new_and_old(const std::string& name, const std::vector<Words>& before, const Words& command,
                         const Words& other, const Words& reads = kSeen) {
        try_scene({name + " to nothing", before, command, reads});
        std::vector<Words> first = before;
        first.push_back(other);
        try_scene({name, first, command, reads});
    }

    static Words further(Words command, const Words& more) {
        command.insert(command.end(), more.begin(), more.end());
        return command;
    }
};

TEST_F(CliFurtherFaults, StepsOfATreatment) {
    try_scene({"fill", {kBegun}, kFilled, kChecked, {{"varnish", "T"}, kChecked}});
    try_scene({"retouch", {kBegun, kFilled}, kRetouched, kChecked, {{"varnish", "T"}, kChecked}});
    try_scene({"quality of it",
               {kBegun, kFilled, kRetouched},
               {"quality", "--treatment", "T"},
               kChecked,
               {{"varnish", "T"}, kChecked}});
}

TEST_F(CliFurtherFaults, PicturesOfATreatment) {
    try_scene({"show",
               {kBegun, kFilled},
               {"treatment", "show", "T", "--state", "filled", "--out", "show.png"},
               kSeen});
    try_scene({"additions", {kBegun, kFilled}, {"treatment", "additions", "T", "--out", "a.png"}, kSeen});
}

TEST_F(CliFurtherFaults, Retouch) {
    const Words retouch = {"retouch", "p.exr", "--mask", "m.png", "--out", "q.exr", "--preview", "q.png"};
    try_new_and_old("retouch", {}, retouch, further(retouch, {"--mode", "neutral"}));
    const Words quality = {"quality", "q.exr", "--mask", "m.png", "--out", "found"};
    try_new_and_old("quality", {retouch}, quality, further(quality, {"--gap-mm", "0.1"}),
                    {"info", "found/gloss.exr"});
}

TEST_F(CliFurtherFaults, Match) {
    const Words match = {"match",    "--srgb", "#406080",      "--max-paints", "2",
                         "--swatch", "s.png",  "--save-pairs", "pairs.json"};
    Words other = match;
    other[2] = "#804060";
    try_new_and_old("match", {}, match, other);
}

TEST_F(CliFurtherFaults, Palette) {
    const Words palette = {"palette", "--card-px", "120", "--save", "k.json", "--out", "k.png"};
    try_new_and_old("palette", {}, palette, further(palette, {"--illuminant", "A"}));
}

TEST_F(CliFurtherFaults, Import) {
    const Words import = {"import", "--diffuse", "photos/img_000.png", "--height", "photos/img_001.png",
                          "--out",  "i.exr"};
    try_new_and_old("import", {}, import, further(import, {"--diffuse-srgb"}));
}

TEST_F(CliFurtherFaults, PicturesInAnotherLight) {
    const Words picture = {"relight", "p.exr", "--light", "0.3,0.3,1", "--out", "r.png"},
                film = {"relight", "p.exr", "--sweep", "0,30",           "--seconds",
                        "0.2",     "--out", "f",       "--frames-width", "24"};
    try_new_and_old("relight", {}, picture, further(picture, {"--gain", "0.5"}));
    // Into a folder that has frames none are written.
    try_scene({"sweep to nothing", {}, film, kSeen, {picture}});
}

TEST_F(CliFurtherFaults, Export) {
    const Words retouch = {"retouch", "p.exr", "--mask", "m.png", "--out", "q.exr"};
    for (const auto& [format, out] : {std::pair("openlime", "o"),
                                      {"layers", "l"},
                                      {"ptm", "e.ptm"},
                                      {"rti", "e.rti"},
                                      {"snapshot", "e.png"},
                                      {"web", "e.html"}}) {
        const Words another = {"export", "p.exr", "--to", format, "--out", out};
        try_new_and_old(std::string("export ") + format, {retouch},
                        {"export", "q.exr", "--to", format, "--out", out},
                        std::string(format) == "layers"
                            ? further({"retouch", "p.exr", "--mask", "m.png"}, {"--out", "other.exr"})
                            : another);
    }
}

}  // namespace
}  // namespace tangi
