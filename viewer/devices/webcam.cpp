#include "viewer/devices/webcam.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <mutex>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/objdetect.hpp>
#include <opencv2/videoio.hpp>
#include <thread>

#include "surface/base/error.h"
#include "viewer/devices/ambient_light_tracking.h"

namespace tangi {

namespace {

using Clock = std::chrono::steady_clock;

constexpr int kFaceWidth = 320, kLightWidth = 64;  // [pixels] that are looked at
constexpr double kSmallestFace = 0.12;             // [1] of the width: an arm's length and farther

cv::Mat grey_of(const cv::Mat& picture, int width) {
    cv::Mat small, grey;
    const double scale = static_cast<double>(width) / picture.cols;
    cv::resize(picture, small, {width, std::max(1, static_cast<int>(std::lround(picture.rows * scale)))}, 0,
               0, cv::INTER_AREA);
    if (small.channels() == 3)
        cv::cvtColor(small, grey, cv::COLOR_BGR2GRAY);
    else
        grey = small;
    return grey;
}

std::vector<FaceBox> faces_in(const cv::Mat& picture, cv::CascadeClassifier& detector) {
    cv::Mat grey = grey_of(picture, kFaceWidth);
    cv::equalizeHist(grey, grey);
    std::vector<cv::Rect> found;
    const int smallest = static_cast<int>(kSmallestFace * kFaceWidth);
    detector.detectMultiScale(grey, found, 1.15, 3, 0, {smallest, smallest});
    std::vector<FaceBox> faces;
    for (const cv::Rect& box : found)
        faces.push_back({(glm::dvec2(box.x + box.width / 2.0, box.y + box.height / 2.0) -
                          0.5 * glm::dvec2(grey.cols, grey.rows)) /
                             static_cast<double>(grey.cols),
                         static_cast<double>(box.width) / grey.cols});
    return faces;
}

Image<float> luminance_of(const cv::Mat& picture) {
    const cv::Mat grey = grey_of(picture, kLightWidth);
    Image<float> luminance(grey.cols, grey.rows);
    for (int y = 0; y < grey.rows; ++y)
        for (int x = 0; x < grey.cols; ++x)
            luminance(x, y) = std::pow(static_cast<float>(grey.at<std::uint8_t>(y, x)) / 255, 2.2f);
    return luminance;
}

bool is_number(const std::string& text) {
    return !text.empty() && text.size() < 4 && text.find_first_not_of("0123456789") == std::string::npos;
}

}  // namespace

std::string face_cascade_file() {
    for (const char* folder : {"/usr/share/opencv4", "/usr/local/share/opencv4", "/usr/share/opencv"}) {
        const auto file = std::filesystem::path(folder) / "haarcascades" / "haarcascade_frontalface_alt2.xml";
        if (std::filesystem::exists(file)) return file.string();
    }
    fail(
        "no face can be found: OpenCV's haarcascade_frontalface_alt2.xml is missing; install it (Debian: "
        "opencv-data)");
}

struct Camera::Impl {
    std::string source;
    std::function<void()> wake;
    mutable std::mutex mutex;
    Wants wants;
    News news;
    bool over = false;
    std::thread thread;

    Impl(std::string from, Wants what, std::function<void()> tell)
        : source(std::move(from)), wake(std::move(tell)), wants(what), thread([this] { run(); }) {}
    ~Impl() {
        {
            const std::lock_guard lock(mutex);
            over = true;
        }
        thread.join();
    }

    void run() {
        std::string lost;
        try {
            watch();
        } catch (const std::exception& error) {  // OpenCV's too
            lost = error.what();
        }
        {
            const std::lock_guard lock(mutex);
            if (over) return;
            news.lost = lost;
        }
        wake();
    }

    void watch() {
        cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
        cv::VideoCapture capture;
        const bool is_camera = is_number(source);
        // Named, since OpenCV would try all that it knows, and some of these leak.
        if (is_camera)
            capture.open(std::stoi(source), cv::CAP_V4L2);
        else
            capture.open(source, cv::CAP_FFMPEG);
        if (!capture.isOpened())
            fail("camera {}: cannot be opened: none is there, or another program has it", source);
        const double fps = capture.get(cv::CAP_PROP_FPS);
        const auto picture_s = std::chrono::duration<double>(1 / (fps >= 1 && fps <= 240 ? fps : 25));
        cv::CascadeClassifier detector;
        const Clock::time_point start = Clock::now();
        std::optional<FaceBox> face;
        cv::Mat picture;
        for (int count = 1;; ++count) {
            if (!capture.read(picture) || picture.empty()) fail("camera {}: gives no more pictures", source);
            if (!is_camera)  // a file would be over in no time
                std::this_thread::sleep_until(start +
                                              std::chrono::duration_cast<Clock::duration>(count * picture_s));
            Wants what;
            {
                const std::lock_guard lock(mutex);
                if (over) return;
                what = wants;
            }
            if (what.head && detector.empty() && !detector.load(face_cascade_file()))
                fail("{}: is no description of faces", face_cascade_file());
            face = what.head ? followed(faces_in(picture, detector), face) : std::nullopt;
            const std::optional<Vec3> light =
                what.light ? brightest_direction(luminance_of(picture)) : std::nullopt;
            {
                const std::lock_guard lock(mutex);
                news = {count, std::chrono::duration<double>(Clock::now() - start).count(), face, light, {}};
            }
            wake();
        }
    }
};

Camera::Camera(std::string source, Wants wants, std::function<void()> wake)
    : impl_(std::make_unique<Impl>(std::move(source), wants, std::move(wake))) {}
Camera::~Camera() = default;

void Camera::want(Wants wants) {
    const std::lock_guard lock(impl_->mutex);
    impl_->wants = wants;
}

Camera::News Camera::fetch() const {
    const std::lock_guard lock(impl_->mutex);
    return impl_->news;
}

}  // namespace tangi
