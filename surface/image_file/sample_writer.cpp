#include "surface/image_file/sample_writer.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <optional>
#include <vector>

#include "surface/base/error.h"
#include "surface/base/json_text.h"
#include "surface/base/memory_error.h"
#include "surface/file/atomic_file.h"
#include "surface/file/atomic_folder.h"
#include "surface/file/file_bytes.h"
#include "surface/file/version.h"
#include "surface/image_file/icc_profile.h"
#include "surface/image_file/image_io.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

std::string format_of(const fs::path& path) {
    const std::string extension = lower_extension(path);
    return extension.empty() ? extension : extension.substr(1);
}

// The same input gives the same bytes: OpenImageIO would write the time at which it runs into EXR and TIFF
// files. Who wants a date there gives it, as other programs take it (reproducible-builds.org).
std::string date_of_file() {
    const char* text = std::getenv("SOURCE_DATE_EPOCH");
    char* end = nullptr;
    const long long seconds = text ? std::strtoll(text, &end, 10) : 0;
    if (!text || end == text || *end != '\0' || seconds < 0 || seconds > 253'402'300'799) return {};
    const auto time = static_cast<std::time_t>(seconds);
    std::tm utc{};
    std::array<char, 32> date{};
    if (!::gmtime_r(&time, &utc) || std::strftime(date.data(), date.size(), "%Y:%m:%d %H:%M:%S", &utc) == 0)
        return {};
    return date.data();
}

bool is_readable(const std::string& format, const std::string& path) {
    const auto input = OIIO::ImageInput::create(format);
    OIIO::ImageSpec spec;
    if (!input || !input->open(path, spec)) return false;
    std::vector<float> row(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.nchannels));
    for (int y = 0; y < spec.height; ++y)
        if (!input->read_scanline(y, 0, OIIO::TypeDesc::FLOAT, row.data()) || input->has_error())
            return false;
    return true;
}

// Where OpenImageIO and its formats have a word for it; XMP holds the rest.
void add_notes(const std::string& extension, const PictureNotes& notes, OIIO::ImageSpec& spec) {
    spec.attribute("Software", program_name());
    if (notes.empty()) return;
    const auto text = [&](const char* name, const std::string& value) {
        if (!value.empty()) spec.attribute(name, valid_utf8(value));
    };
    const bool is_jpeg = extension.starts_with(".jp");
    text("ImageDescription", notes.description);
    text("Artist", notes.creator);
    if (is_jpeg) {  // IPTC-IIM
        text("IPTC:ObjectName", notes.title);
        text("IPTC:Provider", notes.credit);
        text("IPTC:Source", notes.source);
    } else if (!extension.starts_with(".tif")) {
        text("DocumentName", notes.title);
        text("Credit", notes.credit);
        text("Source", notes.source);
    }
    if (extension == ".png") spec.attribute("XML:com.adobe.xmp", xmp_packet(notes));
    if (extension == ".exr") spec.attribute("xmp", xmp_packet(notes));
    if (!(notes.mm_per_pixel > 0)) return;
    if (extension == ".exr") spec.attribute("mm_per_pixel", static_cast<float>(notes.mm_per_pixel));
    const auto per_inch = static_cast<float>(25.4 / notes.mm_per_pixel);
    spec.attribute("ResolutionUnit", "in");
    spec.attribute("XResolution", per_inch);
    spec.attribute("YResolution", per_inch);
}

OIIO::ImageSpec spec_to_write(const std::string& extension, int width, int height,
                              const SampleStorage& storage) {
    const auto& [channels, depth, colour_space, jpeg_quality, is_srgb, notes] = storage;
    OIIO::ImageSpec spec(width, height, channels,
                         depth == SampleDepth::real      ? OIIO::TypeDesc::FLOAT
                         : depth == SampleDepth::sixteen ? OIIO::TypeDesc::UINT16
                                                         : OIIO::TypeDesc::UINT8);
    // A PNG says how it is encoded once: a profile, or an sRGB chunk (ISO/IEC 15948, 11.3.3.3).
    const bool says_it_otherwise = extension == ".png" && is_srgb;
    if (!says_it_otherwise && !colour_space.empty()) spec.attribute("oiio:ColorSpace", colour_space);
    if (extension.starts_with(".tif") || depth == SampleDepth::real)
        spec.attribute("DateTime", date_of_file());
    if (is_srgb) {
        const std::string profile = srgb_icc_profile();
        spec.attribute("ICCProfile", OIIO::TypeDesc(OIIO::TypeDesc::UINT8, static_cast<int>(profile.size())),
                       profile.data());
    }
    add_notes(extension, notes, spec);
    // The lower half of 16 bits is noise, in which looking for more than the nearest matches finds 1 %.
    const bool quick = depth == SampleDepth::sixteen;
    spec.attribute("Compression", extension.starts_with(".jp") ? fmt::format("jpeg:{}", jpeg_quality)
                                                               : (quick ? "zip:1" : "zip"));
    if (quick) spec.attribute("png:compressionLevel", 1);
    return spec;
}

}  // namespace

// A file for OpenImageIO's writers, which notice little of a full disk, and of which libjpeg ends the
// process: they are told that all went well, and `failure` remembers that it did not.
class FileOutput : public OIIO::Filesystem::IOProxy {
public:
    explicit FileOutput(const fs::path& path)
        : IOProxy(path.string(), Write), file_(::open(path.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC)) {
        if (file_ < 0) failure_ = std::strerror(errno);
    }
    ~FileOutput() override {
        if (file_ >= 0) ::close(file_);
    }
    FileOutput(const FileOutput&) = delete;
    FileOutput& operator=(const FileOutput&) = delete;

    // Not "file", which OpenImageIO takes for its own class of that name.
    const char* proxytype() const override { return "checked file"; }
    std::size_t write(const void* bytes, std::size_t count) override {
        pwrite(bytes, count, m_pos);
        m_pos += static_cast<std::int64_t>(count);
        return count;
    }
    std::size_t pwrite(const void* bytes, std::size_t count, std::int64_t offset) override {
        const char* from = static_cast<const char*>(bytes);
        size_ = std::max(size_, static_cast<std::size_t>(offset) + count);
        for (std::size_t left = count; left > 0 && failure_.empty();) {
            const ssize_t written = ::pwrite(file_, from, left, offset);
            if (written < 0 && errno == EINTR) continue;
            if (written <= 0) {
                failure_ = std::strerror(written == 0 ? ENOSPC : errno);
                break;
            }
            from += written;
            offset += written;
            left -= static_cast<std::size_t>(written);
        }
        return count;
    }
    std::size_t size() const override { return size_; }

    const std::string& failure() const { return failure_; }

private:
    int file_;
    std::size_t size_ = 0;
    std::string failure_;
};

struct SampleWriter::Impl {
    Impl(const fs::path& path, int width, int height, const SampleStorage& storage)
        : path_(path), file_(path), storage_(storage), extension_(lower_extension(path)) {
        output_ = OIIO::ImageOutput::create(format_of(path));  // a path may hold a '?'
        if (!output_) fail("{}: no writer for this format: {}", path.string(), OIIO::geterror());
        // The writer of TIFF files takes paths only (OpenImageIO 2.4): what it wrote is read back.
        if (!is_tiff()) proxy_.emplace(file_.temporary());
        if (proxy_) output_->set_ioproxy(&*proxy_);
        written_ =
            output_->open(file_.temporary().string(), spec_to_write(extension_, width, height, storage));
    }

    void write(int begin, int end, const float* rows) {
        written_ = written_ && output_->write_scanlines(begin, end, 0, OIIO::TypeDesc::FLOAT, rows);
        if (!written_ || (proxy_ && !proxy_->failure().empty())) fail_writing();
    }

    void commit() {
        written_ = output_->close() && written_;
        if (!written_ || (proxy_ && !proxy_->failure().empty())) fail_writing();
        if (is_tiff() && !is_readable("tiff", file_.temporary().string())) fail_writing();
        output_.reset();
        proxy_.reset();
        if (!storage_.notes.empty())
            told_of(file_.temporary(), path_,
                    [&] { add_xmp(file_.temporary(), xmp_packet(storage_.notes)); });
        // OpenEXR (3.1) may leave out rows without a word where there was no memory to pack them.
        if (extension_ == ".exr" && !is_readable("openexr", file_.temporary().string())) {
            told_of(file_.temporary(), path_,
                    [&] { require_readable(file_.temporary()); });  // or the disk fails
            fail("{}: cannot be written: {}", path_.string(), kNoMemory);
        }
        file_.commit();
    }

    bool is_tiff() const { return extension_.starts_with(".tif"); }

    [[noreturn]] void fail_writing() {
        const std::string words = output_->geterror();
        std::string why = proxy_ ? proxy_->failure() : refusal_of_more();
        if (why.empty()) why = says_no_memory(words) ? kNoMemory : first_line(words);
        fail("{}: cannot be written: {}", path_.string(), why);
    }

    // What the system says to one more byte at the end.
    std::string refusal_of_more() const {
        const int file = ::open(file_.temporary().c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
        const bool refused = file < 0 || ::write(file, "", 1) != 1;
        const std::string why = refused ? std::strerror(errno) : "";
        if (file >= 0) ::close(file);
        return why;
    }

    fs::path path_;
    AtomicFile file_;
    SampleStorage storage_;
    std::string extension_;
    std::optional<FileOutput> proxy_;
    std::unique_ptr<OIIO::ImageOutput> output_;  // goes before what it writes to
    bool written_ = false;
};

SampleWriter::SampleWriter(const fs::path& path, int width, int height, const SampleStorage& storage)
    : impl_(std::make_unique<Impl>(path, width, height, storage)) {}
SampleWriter::~SampleWriter() = default;
SampleWriter::SampleWriter(SampleWriter&&) noexcept = default;

void SampleWriter::write(int begin, int end, const float* rows) { impl_->write(begin, end, rows); }
void SampleWriter::commit() { impl_->commit(); }

}  // namespace tangi
