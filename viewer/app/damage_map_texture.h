// damage_map_texture.h: the damage map as a texture.
#pragma once

#include "viewer/model/damage_map.h"
#include "viewer/render/objects.h"

namespace tangi {

class MapTexture {
public:
    // Uploads a part of the picture; all of it where it is new.
    void update(const DamageMap::Picture& picture, const Region& changed);
    void clear() { texture_ = gl::Texture(); }
    unsigned id() const { return texture_ ? texture_.id() : 0; }

private:
    gl::Texture texture_;
};

}  // namespace tangi
