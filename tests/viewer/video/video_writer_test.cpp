// video_writer_test.cpp: films of pictures: what is stored can be seen again, and is there whole or not at
// all.
#include "viewer/video/video_writer.h"

#include <gmock/gmock.h>
#include <opencv2/videoio.hpp>

#include "surface/file/version.h"
#include "tests/support/test_support.h"
#include "viewer/video/ffmpeg_writer_file.h"
#include "viewer/video/light_sweep.h"
#include "viewer/video/video_recorder.h"

namespace tangi {
namespace {

Image<Rgb> plain(int width, int height, const Rgb& colour) {
    Image<Rgb> picture(width, height);
    for (Rgb& pixel : picture.pixels()) pixel = colour;
    return picture;
}

// ITU-R BT.709-6, table 3, in 8 bits: black is 16, white 235, greys have no chroma; the colour bars of 100 %.
TEST(VideoPlanes, AreThoseOfTheRecommendation) {
    const auto first = [](const Rgb& colour) {
        const VideoPlanes planes = video_planes(plain(4, 2, colour));
        return std::array<int, 3>{planes.luma[3], planes.blue[1], planes.red[1]};
    };
    EXPECT_THAT(first({0, 0, 0}), testing::ElementsAre(16, 128, 128));
    EXPECT_THAT(first({1, 1, 1}), testing::ElementsAre(235, 128, 128));
    EXPECT_THAT(first({0.5f, 0.5f, 0.5f}), testing::ElementsAre(126, 128, 128));
    EXPECT_THAT(first({1, 1, 0}), testing::ElementsAre(219, 16, 138));
    EXPECT_THAT(first({0, 1, 0}), testing::ElementsAre(173, 42, 26));
    EXPECT_THAT(first({1, 0, 0}), testing::ElementsAre(63, 102, 240));
    EXPECT_THAT(first({0, 0, 1}), testing::ElementsAre(32, 240, 118));
}

TEST(VideoPlanes, OddSidesBecomeEvenAndChromaLiesAtTheLeft) {
    Image<Rgb> picture = plain(5, 3, {0, 0, 0});
    for (int y = 0; y < 3; ++y) picture(2, y) = {0, 0, 1};
    const VideoPlanes planes = video_planes(picture);
    EXPECT_EQ(planes.width, 6);
    EXPECT_EQ(planes.height, 4);
    EXPECT_EQ(planes.luma.size(), 24u);
    EXPECT_THAT(planes.blue, testing::ElementsAre(128, 184, 128, 128, 184, 128)) << "half of column 2";
}

TEST(Film, VideosShowWhatWasAdded) {
    for (const char* name : {"a b:c?.mp4", "a.webm"}) {
        const TestDir folder;
        const auto file = folder / name;
        const auto grey = [](int i) { return 0.1f + 0.08f * static_cast<float>(i); };
        {
            const auto film = make_film(file, 25);
            for (int i = 0; i < 10; ++i) film->add(plain(65, 49, Rgb(grey(i))));
            EXPECT_FALSE(std::filesystem::exists(file)) << "before it is whole";
            film->finish();
        }
        EXPECT_EQ(names_in(folder.path()), std::vector<std::string>{name});
        EXPECT_NE(bytes_of(file).find(program_name()), std::string::npos) << name;
        std::filesystem::rename(file, folder / "plain");
        cv::VideoCapture video((folder / "plain").string(), cv::CAP_FFMPEG);
        ASSERT_TRUE(video.isOpened());
        EXPECT_NEAR(video.get(cv::CAP_PROP_FPS), 25, 0.01);
        cv::Mat picture;
        int count = 0;
        for (; video.read(picture); ++count) {
            ASSERT_EQ(picture.cols, 66);
            ASSERT_EQ(picture.rows, 50);
            EXPECT_NEAR(picture.at<cv::Vec3b>(20, 30)[1], 255 * grey(count), 3) << name << " " << count;
        }
        EXPECT_EQ(count, 10);
    }
}

TEST(Film, VideosOfTheSamePicturesAreTheSame) {
    for (const std::string ending : {".mp4", ".webm"}) {
        const TestDir folder;
        for (const char* name : {"a", "b"}) {
            const auto film = make_film(folder / (name + ending), 25);
            for (int i = 0; i < 3; ++i) film->add(plain(32, 24, Rgb(0.3f * static_cast<float>(i))));
            film->finish();
        }
        EXPECT_EQ(bytes_of(folder / ("a" + ending)), bytes_of(folder / ("b" + ending))) << ending;
    }
}

TEST(Film, FramesAreThePicturesThemselves) {
    const TestDir folder;
    const auto frames = folder / "frames";
    {
        const auto film = make_film(frames, 25);
        for (const float grey : {0.2f, 0.6f}) film->add(plain(3, 2, Rgb(grey)));
        film->finish();
    }
    EXPECT_THAT(names_in(frames), testing::ElementsAre("frame-00001.png", "frame-00002.png"));
    EXPECT_NEAR(read_picture(frames / "frame-00002.png")(1, 1).g, 0.6f, 0.5f / 255);
    EXPECT_THROW(make_film(frames, 25), Error) << "a second film over the first";
}

TEST(Film, OneThatIsNotFinishedIsGone) {
    const TestDir folder;
    std::filesystem::create_directory(folder / "kept");
    for (const char* name : {"a.mp4", "a.webm", "frames", "kept"}) {
        const auto film = make_film(folder / name, 25);
        film->add(plain(16, 16, Rgb(0.5f)));
    }
    EXPECT_THAT(names_in(folder.path()), testing::ElementsAre("kept"));
    EXPECT_THAT(names_in(folder / "kept"), testing::IsEmpty());
}

TEST(Film, SaysWhatIsWrong) {
    const TestDir folder;
    EXPECT_THROW(make_film(folder / "none" / "a.mp4", 25), Error);
    const auto film = make_film(folder / "a.mp4", 25);
    film->add(plain(16, 16, Rgb(0.5f)));
    EXPECT_THROW(film->add(plain(18, 16, Rgb(0.5f))), ContractError);
    EXPECT_THROW(make_film(folder / "b.webm", 25)->add(plain(70'000, 2, Rgb(0))), Error);
}

TEST(Recorder, WritesWhatItIsGivenAndStops) {
    const TestDir folder;
    const auto record = [&](const char* name, int given) {
        Recorder recorder(folder / name, 25, 5, [] {});
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
        int next = 0;
        while (next < given && std::chrono::steady_clock::now() < end)
            if (recorder.next() == next) {
                recorder.add(plain(16, 16, Rgb(0.5f)));
                ++next;
            }
        if (given < 5) recorder.stop();
        while (!recorder.state().over && std::chrono::steady_clock::now() < end)
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        EXPECT_EQ(recorder.next(), given == 5 ? -1 : recorder.next());
        return recorder.state();
    };
    EXPECT_EQ(record("whole.mp4", 5).error, "");
    EXPECT_TRUE(record("half.mp4", 3).cancelled);
    EXPECT_THAT(record("none/a.mp4", 0).error, testing::HasSubstr("none"));
    EXPECT_THAT(names_in(folder.path()), testing::ElementsAre("whole.mp4"));
}

TEST(SweepPath, OneCornerGoesOnceRoundAndCanBeRepeated) {
    const auto path = sweep_path({{30, 20}}, 8);
    ASSERT_EQ(path.size(), 8u);
    for (std::size_t i = 0; i < 8; ++i) {
        EXPECT_NEAR(path[i].azimuth_deg, 30 + 45.0 * static_cast<double>(i), 1e-9);
        EXPECT_NEAR(path[i].elevation_deg, 20, 1e-9);
    }
}

TEST(SweepPath, EndsAtTheLastCornerEquallyFast) {
    // Both legs are equally long: 60 degrees of elevation, 120 of azimuth at an elevation of 60.
    const auto path = sweep_path({{0, 0.001}, {0, 60}, {120, 60}}, 5);
    EXPECT_NEAR(path[1].elevation_deg, 30, 0.01);
    EXPECT_NEAR(path[2].elevation_deg, 60, 0.01);
    EXPECT_NEAR(path[3].azimuth_deg, 60, 0.01);
    EXPECT_NEAR(path[4].azimuth_deg, 120, 1e-9);
    EXPECT_EQ(sweep_path({{10, 20}, {10, 20}}, 3).back().azimuth_deg, 10) << "a way of no length";
    EXPECT_EQ(sweep_path({{10, 20}}, 1).size(), 1u);
}

}  // namespace
}  // namespace tangi
