#include "viewer/app/damage_map_texture.h"

#include <epoxy/gl.h>

namespace tangi {

void MapTexture::update(const DamageMap::Picture& picture, const Region& changed) {
    Region r = changed;
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    if (!texture_) {
        texture_ = gl::make_texture();
        glBindTexture(GL_TEXTURE_2D, texture_.id());
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);  // pixels can be told apart
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, picture.width(), picture.height(), 0, GL_RGBA,
                     GL_UNSIGNED_BYTE, nullptr);
        r = picture.region();
    }
    glBindTexture(GL_TEXTURE_2D, texture_.id());
    glPixelStorei(GL_UNPACK_ROW_LENGTH, picture.width());
    glTexSubImage2D(GL_TEXTURE_2D, 0, r.x0, r.y0, r.width(), r.height(), GL_RGBA, GL_UNSIGNED_BYTE,
                    &picture(r.x0, r.y0));
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
    glBindTexture(GL_TEXTURE_2D, 0);
}

}  // namespace tangi
