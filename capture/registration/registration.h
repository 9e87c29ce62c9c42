// registration.h: how far the camera moved from one photograph of a stack to the next, whatever the light
// did.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "capture/registration/alignment.h"
#include "capture/stack/stack.h"

namespace tangi {

// Where registration looks at photographs: an overview of each, and where that is reduced, patches in full
// resolution. One for all photographs of a stack, fitted or held out, since they are laid onto each other.
struct RegistrationGrid {
    // By the pictures' size and the number of all photographs, of which a bounded number of bytes is kept.
    // Which of them are held out changes nothing.
    explicit RegistrationGrid(const Stack& stack);

    int width = 0, height = 0;
    glm::dvec2 corner{0};             // of the stack, in the photographs
    int reduction = 1;                // of the overview
    std::vector<glm::ivec2> patches;  // [pixels of the stack] corners; none where the overview is whole
};

// What registration needs of photographs. Takes bands as they are read for another purpose.
class PictureCollector {
public:
    explicit PictureCollector(const Stack& stack);               // of stack.photos, on the whole stack's grid
    PictureCollector(const RegistrationGrid& grid, int photos);  // of others of that stack

    // A band of these photographs, as stored (Transfer{}). Bands must cover the stack, ascending.
    void add(const Band& band);

    int photos() const { return photos_; }
    // The parts that are kept in full resolution: the patches, or the whole picture where that is small.
    std::vector<const AlignmentWindow*> in_full() const;
    const RegistrationGrid& grid() const { return grid_; }

    // Forgets the photographs that are not kept, in their order.
    void keep(const std::vector<bool>& kept);

private:
    friend class Registrar;
    RegistrationGrid grid_;
    int photos_ = 0;
    AlignmentWindow overview_;
    std::vector<AlignmentWindow> patches_;  // brightness as stored, as the overview's; the grid's
    Image<float> counts_;                   // stored pixels in each of the overview's
};

struct PhotoDrift {
    std::string name;
    bool registered = true;    // false: nothing in it was found again
    bool warped = false;       // it drifted by more than the uncertainty, so `homography` is applied
    Homography homography{1};  // pixel of the reference -> pixel of this photograph
    MotionModel model = MotionModel::none;
    double drift_px = 0;     // [pixels] root mean square over the picture
    double error_px = 0;     // [pixels] its standard error
    double correlation = 0;  // [1] with what the other photographs predict
    // [unit vector] The light that it shows and was registered under, where that is clearly not the listed
    // one.
    std::optional<glm::dvec3> per_photo_light{};
};

struct Registration {
    std::string reference;           // name of the photograph whose frame the painting has; empty: not done
    bool moved = false;              // something is warped
    double shading_px = 0;           // [pixels] rms of apparent motion that goes with the light: not believed
    double typical_drift_px = 0;     // [pixels] median
    std::vector<PhotoDrift> photos;  // of stack.photos, as they were
    std::vector<PhotoDrift> held_out;  // of stack.held_out
};

// Registers the photographs of a stack to the first of them (by path, held out or not), and stores in each
// that drifted its homography. Held-out photographs are read here, and have no say in the others'
// registration. `collected` has the stack's photographs; the transfer curve need not be exact. A photograph
// that its listed light explains badly, and another one well, is registered under that; its light stays as
// listed. Photographs
// that cannot be registered are left out of a stack that moved, with a warning that names them; in one that
// did not, only those that show something else. Throws Error where fewer than 4 remain.
// docs/theory/registration.md says how, and what decides that a stack moved.
Registration register_stack(Stack& stack, const PictureCollector& collected, const Transfer& transfer,
                            const Progress& progress = {});

// Reads the stack for it; for callers that have no other use for the bands.
Registration register_stack(Stack& stack, const Transfer& transfer, const Progress& progress = {});

// The homography from pixels of `reference` to pixels of `moved` (of the same painting at another time, by
// another camera or light: before and after a treatment), with its standard error. Brightness in any unit.
// Throws Error where nothing of one is found in the other.
PhotoDrift register_pictures(const Image<float>& reference, const Image<float>& moved);

nlohmann::json to_json(const Registration& registration);

}  // namespace tangi
