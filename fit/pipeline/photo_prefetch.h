// photo_prefetch.h: the photographs of a stack as stored, one after the other, the next one decoded
// meanwhile.
#pragma once

#include <future>
#include <vector>

#include "capture/stack/stack.h"

namespace tangi {

// One photograph, values as stored; grey is RGB. Pixels that a registered photograph does not reach, or of
// which it has no sample, are black.
struct StoredPhoto {
    Image<Rgb> picture;
    Image<unsigned char> missing;  // 1 for these; empty where there are none
};

class PhotosAhead {
public:
    // `photos`: which, instead of those of the stack. Values are multiplied by `unit`.
    PhotosAhead(const Stack& stack, std::vector<StackPhoto> photos, float unit = 1);
    ~PhotosAhead();  // waits for the one being decoded
    PhotosAhead(const PhotosAhead&) = delete;
    PhotosAhead& operator=(const PhotosAhead&) = delete;

    // The next one, valid until the call after; there must be one. Throws PhotoError where it is damaged;
    // the one after it can be had all the same.
    const StoredPhoto& next();

private:
    void start();
    void decode(std::size_t index, StoredPhoto& into);

    Stack one_;  // with one photograph at a time
    std::vector<StackPhoto> photos_;
    const float unit_;
    std::size_t started_ = 0;  // photographs begun
    StoredPhoto now_, ahead_;  // used again: room for new ones takes the system as long as decoding
    std::future<void> decoding_;
};

}  // namespace tangi
