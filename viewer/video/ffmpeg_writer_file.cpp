#include "viewer/video/ffmpeg_writer_file.h"

#include <fmt/format.h>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
}

#include <algorithm>
#include <array>
#include <cmath>

#include "surface/base/error.h"
#include "surface/file/atomic_file.h"
#include "surface/file/output_set.h"
#include "surface/file/version.h"
#include "surface/image_file/image_io.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

// Same bytes for the same pictures (AVFMT_FLAG_BITEXACT) leave out Matroska's own ENCODER.
struct Codec {
    const char *extension, *encoder, *container, *program;  // the container's word for what wrote it
    std::array<std::pair<const char*, const char*>, 4> settings;
};
// Quality: differences are seen in no picture by itself.
constexpr std::array<Codec, 2> kCodecs = {
    {{".mp4",
      "libx264",
      "mp4",
      "encoding_tool",
      {{{"crf", "16"}, {"preset", "medium"}, {"profile", "high"}, {}}}},
     {".webm",
      "libvpx-vp9",
      "webm",
      "SOFTWARE",
      {{{"crf", "20"}, {"deadline", "good"}, {"cpu-used", "4"}, {"row-mt", "1"}}}}}};

struct Freed {
    void operator()(AVCodecContext* it) const { avcodec_free_context(&it); }
    void operator()(AVFrame* it) const { av_frame_free(&it); }
    void operator()(AVPacket* it) const { av_packet_free(&it); }
    void operator()(AVFormatContext* it) const {
        if (it->pb) avio_closep(&it->pb);
        avformat_free_context(it);
    }
};

class Video : public Film {
public:
    Video(const fs::path& file, double frames_per_s) : file_(file) {
        av_log_set_level(AV_LOG_QUIET);  // libraries print nothing
        for (const Codec& codec : kCodecs)
            if (lower_extension(file) == codec.extension) codec_ = &codec;
        TP_REQUIRE(codec_, "a video has an extension that names its encoding");
        encoder_ = avcodec_find_encoder_by_name(codec_->encoder);
        if (!encoder_)
            fail("{}: this machine's FFmpeg has no encoder {}; write {} instead, or pictures into a folder",
                 file.string(), codec_->encoder,
                 codec_ == &kCodecs[0] ? kCodecs[1].extension : kCodecs[0].extension);
        frame_s_ = av_d2q(1 / frames_per_s, 1'000'000);
    }

    void add(const Image<Rgb>& encoded_srgb) override {
        const VideoPlanes planes = video_planes(encoded_srgb);
        if (!context_) begin(planes);
        TP_REQUIRE(planes.width == context_->width && planes.height == context_->height,
                   "pictures of a video have one size");
        require(av_frame_make_writable(frame_.get()), "memory");
        copy(planes.luma, planes.width, 0);
        copy(planes.blue, planes.width / 2, 1);
        copy(planes.red, planes.width / 2, 2);
        frame_->pts = next_++;
        encode(frame_.get());
    }

    void complete() override {
        TP_REQUIRE(context_, "a video has pictures");
        encode(nullptr);
        require(av_write_trailer(format_.get()), "writing");
        require(avio_closep(&format_->pb), "writing");
    }
    void add_to(OutputSet& set) override { set.add(file_); }

private:
    void require(int code, const char* what) const {
        if (code >= 0) return;
        std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
        av_strerror(code, text.data(), text.size());
        fail("{}: {} failed: {}", file_.target().string(), what, text.data());
    }

    void begin(const VideoPlanes& planes) {
        const std::string url = "file:" + file_.temporary().string();  // a name may have a colon
        AVFormatContext* format = nullptr;
        require(avformat_alloc_output_context2(&format, nullptr, codec_->container, url.c_str()), "memory");
        format_.reset(format);
        format->flags |= AVFMT_FLAG_BITEXACT;  // the same pictures, the same bytes: no random numbers
        context_.reset(avcodec_alloc_context3(encoder_));
        AVStream* stream = avformat_new_stream(format, nullptr);
        frame_.reset(av_frame_alloc());
        packet_.reset(av_packet_alloc());
        if (!context_ || !stream || !frame_ || !packet_) throw std::bad_alloc();
        AVCodecContext& c = *context_;
        c.flags |= AV_CODEC_FLAG_BITEXACT;
        c.width = planes.width;
        c.height = planes.height;
        c.pix_fmt = AV_PIX_FMT_YUV420P;
        c.time_base = frame_s_;
        c.framerate = av_inv_q(frame_s_);
        c.gop_size =
            std::max(1, static_cast<int>(std::lround(1 / av_q2d(frame_s_))));  // one can go to every second
        c.color_range = AVCOL_RANGE_MPEG;
        c.color_primaries = AVCOL_PRI_BT709;
        c.color_trc = AVCOL_TRC_IEC61966_2_1;
        c.colorspace = AVCOL_SPC_BT709;
        c.chroma_sample_location = AVCHROMA_LOC_LEFT;
        if (format->oformat->flags & AVFMT_GLOBALHEADER) c.flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
        for (const auto& [name, value] : codec_->settings)
            if (name) require(av_opt_set(c.priv_data, name, value, 0), name);
        if (avcodec_open2(&c, encoder_, nullptr) < 0)
            fail("{}: the encoder {} takes no pictures of {} x {} pixels; make them smaller",
                 file_.target().string(), codec_->encoder, c.width, c.height);
        require(avcodec_parameters_from_context(stream->codecpar, &c), "memory");
        stream->time_base = c.time_base;
        stream->avg_frame_rate = c.framerate;
        frame_->format = c.pix_fmt;
        frame_->width = c.width;
        frame_->height = c.height;
        require(av_frame_get_buffer(frame_.get(), 0), "memory");
        require(avio_open(&format->pb, url.c_str(), AVIO_FLAG_WRITE), "opening");
        av_dict_set(&format->metadata, codec_->program, program_name().c_str(), 0);
        // Players begin before they have all of it: the index goes in front.
        AVDictionary* options = nullptr;
        if (codec_ == &kCodecs[0]) av_dict_set(&options, "movflags", "+faststart", 0);
        const int written = avformat_write_header(format, &options);
        av_dict_free(&options);
        require(written, "writing");
    }

    void copy(const std::vector<std::uint8_t>& plane, int width, std::size_t which) {
        const auto across = static_cast<std::size_t>(width);
        for (std::size_t y = 0; y < plane.size() / across; ++y)
            std::copy_n(plane.data() + y * across, across,
                        frame_->data[which] + static_cast<std::ptrdiff_t>(y) * frame_->linesize[which]);
    }

    // Null: what the encoder still holds.
    void encode(const AVFrame* frame) {
        require(avcodec_send_frame(context_.get(), frame), "encoding");
        for (;;) {
            const int code = avcodec_receive_packet(context_.get(), packet_.get());
            if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) return;
            require(code, "encoding");
            packet_->stream_index = 0;
            av_packet_rescale_ts(packet_.get(), context_->time_base, format_->streams[0]->time_base);
            require(av_interleaved_write_frame(format_.get(), packet_.get()), "writing");
            require(format_->pb->error, "writing");
        }
    }

    AtomicFile file_;
    const Codec* codec_ = nullptr;
    const AVCodec* encoder_ = nullptr;
    AVRational frame_s_{1, 25};
    std::unique_ptr<AVFormatContext, Freed> format_;
    std::unique_ptr<AVCodecContext, Freed> context_;
    std::unique_ptr<AVFrame, Freed> frame_;
    std::unique_ptr<AVPacket, Freed> packet_;
    std::int64_t next_ = 0;
};

}  // namespace

VideoPlanes video_planes(const Image<Rgb>& picture) {
    TP_REQUIRE(picture.width() > 0 && picture.height() > 0, "a picture of a video is not empty");
    VideoPlanes planes;
    planes.width = picture.width() + picture.width() % 2;
    planes.height = picture.height() + picture.height() % 2;
    const auto width = static_cast<std::size_t>(planes.width),
               height = static_cast<std::size_t>(planes.height);
    planes.luma.resize(width * height);
    std::vector<float> blue(width * height), red(width * height);
    const auto stored = [](float v, float lowest, float range) {
        return static_cast<std::uint8_t>(std::lround(lowest + range * v));
    };
    std::size_t at = 0;
    for (int y = 0; y < planes.height; ++y)
        for (int x = 0; x < planes.width; ++x, ++at) {
            const Rgb c = glm::clamp(
                picture(std::min(x, picture.width() - 1), std::min(y, picture.height() - 1)), 0.0f, 1.0f);
            const float luma = 0.2126f * c.r + 0.7152f * c.g + 0.0722f * c.b;
            planes.luma[at] = stored(luma, 16, 219);
            blue[at] = (c.b - luma) / 1.8556f;
            red[at] = (c.r - luma) / 1.5748f;
        }
    // A sample of chroma lies on the left of its two columns, and between its two rows.
    const auto halved = [&](const std::vector<float>& plane, std::vector<std::uint8_t>& half) {
        half.reserve(width * height / 4);
        for (std::size_t y = 0; y < height; y += 2)
            for (std::size_t x = 0; x < width; x += 2) {
                float sum = 0;
                for (const std::size_t row : {y, y + 1}) {
                    const float* p = plane.data() + row * width;
                    sum += p[x == 0 ? 0 : x - 1] + 2 * p[x] + p[x + 1];
                }
                half.push_back(stored(sum / 8, 128, 224));
            }
    };
    halved(blue, planes.blue);
    halved(red, planes.red);
    return planes;
}

std::unique_ptr<Film> make_video(const fs::path& file, double frames_per_s) {
    return std::make_unique<Video>(file, frames_per_s);
}

}  // namespace tangi
