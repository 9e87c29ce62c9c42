#include "viewer/app/comparison_textures.h"

namespace tangi {

namespace {

gl::Texture texture_of(HeldPhoto::Picture picture, const Monitor* monitor) {
    if (monitor) monitor->apply({&picture.data()->r, 3 * picture.pixels().size()});
    gl::Texture texture = gl::make_texture();
    glBindTexture(GL_TEXTURE_2D, texture.id());
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);  // pixels can be told apart
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, picture.width(), picture.height(), 0, GL_RGB, GL_UNSIGNED_BYTE,
                 picture.data());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glGenerateMipmap(GL_TEXTURE_2D);
    glBindTexture(GL_TEXTURE_2D, 0);
    return texture;
}

bool shows_pictures(CompareWay way) {
    return way == CompareWay::aside || way == CompareWay::wipe || way == CompareWay::blink;
}

}  // namespace

bool HeldPictures::show(const Comparing& comparing, const Monitor* monitor) {
    const auto& held = comparing.held();
    const bool same_pictures = shows_pictures(way_) && shows_pictures(comparing.way);
    if (held == held_ && (way_ == comparing.way || same_pictures)) {
        way_ = comparing.way;
        return false;
    }
    held_ = held;
    way_ = comparing.way;
    second_ = shows_pictures(way_) ? 1 : 0;
    textures_[0] = texture_of(second_ == 1                  ? held->photo
                              : way_ == CompareWay::delta_e ? held->delta_e
                                                            : held->difference,
                              monitor);
    if (second_ == 1) textures_[1] = texture_of(held->relit, monitor);
    return true;
}

void HeldPictures::clear() {
    held_.reset();
    for (gl::Texture& texture : textures_) texture = gl::Texture();
}

}  // namespace tangi
