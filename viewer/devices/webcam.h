// webcam.h: a webcam that looks at whoever looks at the painting: where the head is, where the light is.
//
// On a thread of its own. Pictures stay there: none is kept, shown or written.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "viewer/devices/head_tracking.h"

namespace tangi {

class Camera {
public:
    struct Wants {
        bool head = false, light = false;
        friend bool operator==(const Wants&, const Wants&) = default;
    };
    // `source`: the number of a camera ("0"), or a video file in its place. Never throws for a camera that is
    // not there: news say so. `wake`, from its thread, says that there is news.
    Camera(std::string source, Wants wants, std::function<void()> wake);
    ~Camera();
    Camera(const Camera&) = delete;
    Camera& operator=(const Camera&) = delete;

    void want(Wants wants);

    struct News {
        int pictures = 0;             // since it was opened
        double time_s = 0;            // of the last one, since then
        std::optional<FaceBox> face;  // in it
        std::optional<Vec3> light;    // towards the brightest direction
        std::string lost;             // why there are no more
    };
    News fetch() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

// OpenCV's description of a face from ahead. Throws Error, naming the package, where it is not installed.
std::string face_cascade_file();

}  // namespace tangi
