// comparison_textures.h: the pictures of a photograph and of the relit painting as textures.
#pragma once

#include "viewer/model/photo_source.h"
#include "viewer/model/window_state.h"
#include "viewer/render/display_profile.h"
#include "viewer/render/objects.h"

namespace tangi {

class HeldPictures {
public:
    // Uploads what this way of looking needs and is not there yet, in the monitor's colours where one is
    // given. True where something changed.
    bool show(const Comparing& comparing, const Monitor* monitor = nullptr);
    void clear();

    // Textures of the photograph and the relit painting, or of the map of differences (both the same).
    GLuint left() const { return textures_[0].id(); }
    GLuint right() const { return textures_[second_].id(); }

private:
    std::shared_ptr<const HeldPhoto> held_;
    CompareWay way_ = CompareWay::wipe;
    gl::Texture textures_[2];
    std::size_t second_ = 1;
};

}  // namespace tangi
