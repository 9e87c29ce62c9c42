// stack.h: the photographs of one painting under many lights, opened, matched and checked, read band by band.
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "capture/formats/capture_colour.h"
#include "capture/formats/picture_geometry.h"
#include "capture/photo/development.h"
#include "capture/photo/photo_file.h"
#include "surface/base/progress.h"
#include "surface/image/colour.h"
#include "surface/image/homography.h"
#include "surface/image/image.h"
#include "surface/maps/light.h"

namespace tangi {

struct StackOptions {
    // .lp, .dome, .relight or capture.json; where empty, the one .lp of the folder, else the one of the
    // others.
    std::optional<std::filesystem::path> lights_file{};
    // The vectors of an .lp are positions in mm from the picture's centre, not directions.
    bool lights_in_mm = false;
    // A capture.json of which all but its lights is used; lights then come from lights_file.
    std::optional<std::filesystem::path> capture_file{};
    std::optional<Region> crop{};                      // [pixels of the whole picture] the part to read
    std::optional<std::filesystem::path> mask_file{};  // a picture like a photograph; what is black is not
                                                       // fitted
    std::optional<Transfer> transfer{};                // estimated from the photographs where empty
    DevelopOptions develop{};                          // frames and brackets (development.h)
};

// One photograph of a stack and its light.
struct StackPhoto {
    std::filesystem::path path;
    Light light;
    int number = 0;  // position in the lights file, from 0
    // Pixel of the stack's reference frame -> pixel of this photograph, both whole, and without the lens's
    // distortion and rectified alike where the stack has a geometry; the same where empty.
    std::optional<Homography> homography{};
    // More than one where the photograph is a bracket; `path` is then the one nearest to the reference
    // exposure.
    std::vector<Exposure> exposures{};
    // [deg] Standard error of the light's direction, where a calibration by spheres tells it; else 0.
    double direction_sigma_deg = 0;
};

// Photographs of one size on disk, and all that is known of them. Pixels are read by StackReader. A stack of
// camera raws, or for which `develop` asks something, is to be developed before it is read (develop_stack).
struct PhotoProfiles;

struct Stack {
    std::filesystem::path folder;
    std::vector<StackPhoto> photos;    // to fit
    std::vector<StackPhoto> held_out;  // kept from the fit, to compare with (hold_out)
    Region crop;                       // in the whole picture; (0, 0) of the stack is its corner
    // The whole picture, where that is not the photographs as they are: undistorted, rectified.
    std::optional<PictureGeometry> geometry{};
    int channels = 3;          // 1 or 3, the same in all photographs
    int bits = 8;              // as PhotoHeader::bits; 32 once developed: linear light
    bool is_raw = false;       // camera raw
    bool says_linear = false;  // as PhotoHeader::says_linear
    // [1] Of the files' numbers: the stored value that is full scale, by which they are divided. Below 1 for
    // integers of fewer bits than their files have, above 1 for floats that are codes (full_scale.h).
    double full_scale = 1;
    bool float_codes = false;            // files of floats that are read as integers of 16 bits
    int orientation = 1;                 // EXIF, of all; not applied
    std::optional<Transfer> transfer{};  // empty until known (estimate_transfer)
    // From a capture.json, .dome or .relight, in the frame of the crop; the lights have positions and gains
    // then.
    std::optional<double> mm_per_pixel{};
    std::optional<Vec3> camera_mm{};
    std::optional<CaptureColour> colour{};             // of the chart in it
    bool transfer_of_chart = false;                    // `transfer` is the one that this chart fits
    Image<unsigned char> mask;                         // size of the crop, 0 = leave out; empty = everything
    std::vector<std::string> warnings;                 // for the user, each naming the file it is about
    DevelopOptions develop{};                          // what was asked for
    std::shared_ptr<const Development> development{};  // how photographs are read; empty: as stored
    std::shared_ptr<const PhotoProfiles> profiles{};   // where they have not all the same ICC profile

    int width() const { return crop.width(); }
    int height() const { return crop.height(); }
    std::vector<Light> lights() const;
};

// Opens the photographs of a folder that the lights file lists; lights are matched by name (path, file name,
// stem; case does not matter), or by order with a warning where no name at all matches and the numbers agree.
// Only headers are read. Photographs lit from below the painting's plane are left out with a warning. Throws
// Error naming the file, the place and the remedy: no such folder, no lights file or several, a listed
// photograph that is missing, sizes or channels that differ, a crop outside, a mask of another size.
Stack open_stack(const std::filesystem::path& folder, const StackOptions& options = {});

// Photographs whose lights are not known yet, in the order given; all lights are (0, 0, 1). Brackets "auto"
// are photographs NAME_1, NAME_2 …, as in brackets.h. Only headers are read. Throws Error as open_stack().
Stack open_photographs(const std::vector<std::filesystem::path>& paths, const StackOptions& options = {});

// Moves photographs from `photos` to `held_out`. `which` is a comma-separated list of positions in the lights
// file (from 0), names, or START:STEP (every STEP-th from START on): "4:8", "4,12,20", "img_004.jpg". Throws
// Error where a name or position is not in the stack; START:STEP passes over photographs that were left out.
void hold_out(Stack& stack, const std::string& which);

// Throws Error where photometric stereo has no unique answer: fewer than 4 lights, or all in one plane.
void require_enough_lights(const std::vector<Light>& lights, const std::string& what);

// Memory of bands, used again: each page of new memory is cleared by the system when it is touched, which
// took an eighth of a whole fit's processor time. Any thread may take and give back.
class BandMemory : public std::enable_shared_from_this<BandMemory> {
public:
    // Gives values back to where they are from, if that is still there.
    struct GiveBack {
        std::weak_ptr<BandMemory> memory{};
        std::size_t size = 0;
        void operator()(float* values) const noexcept;
    };
    using Values = std::unique_ptr<float[], GiveBack>;

    // At least so many values, of which none is set.
    Values take(std::size_t count);

private:
    std::mutex mutex_;
    std::size_t blocks_ = 0;                                              // that were made
    std::vector<std::pair<std::size_t, std::unique_ptr<float[]>>> free_;  // with their sizes
};

// Linear light of all photographs in rows y0 <= y < y1 of the stack, planar: [photo][channel][row][column].
class Band {
public:
    Band() = default;
    Band(int photos, int channels, int width, int y0, int y1);  // of zeros
    // Of values that are not set yet.
    Band(int photos, int channels, int width, int y0, int y1, BandMemory& memory);

    int photos() const { return photos_; }
    int channels() const { return channels_; }
    int width() const { return width_; }
    int y0() const { return y0_; }
    int y1() const { return y1_; }
    // The same rows, counted from another one: row y is y + rows now.
    Band moved(int rows) &&;
    float* row(int photo, int channel, int y) { return &values_[index(photo, channel, y)]; }
    const float* row(int photo, int channel, int y) const { return &values_[index(photo, channel, y)]; }

private:
    std::size_t size() const { return index(photos_, 0, y0_); }
    std::size_t index(int photo, int channel, int y) const {
        const auto plane = static_cast<std::size_t>(photo) * static_cast<std::size_t>(channels_) +
                           static_cast<std::size_t>(channel);
        return (plane * static_cast<std::size_t>(y1_ - y0_) + static_cast<std::size_t>(y - y0_)) *
               static_cast<std::size_t>(width_);
    }
    int photos_ = 0, channels_ = 0, width_ = 0, y0_ = 0, y1_ = 0;
    BandMemory::Values values_;
};

class PhotoSource;

// Reads bands of a stack, all photographs side by side. Each photograph is decoded once as long as bands
// ascend.
class StackReader {
public:
    explicit StackReader(const Stack& stack);  // keeps a reference
    ~StackReader();
    StackReader(const StackReader&) = delete;
    StackReader& operator=(const StackReader&) = delete;

    // Linearised by `transfer`; Transfer{} (linear) gives the values as stored. Uses all threads. Photographs
    // with a homography, and all of a stack with a geometry, are resampled (Lanczos 3) in what `transfer`
    // gives: NaN where a pixel lies outside or a neighbour is NaN, as pixels without a sample are
    // (PhotoFile::read_rows()), and the highest value it is made of where one of its nearest
    // four is clipped. Of a developed stack, clipped values are Development::clipped; else those from
    // kClipped on are.
    Band read(int y0, int y1, const Transfer& transfer);

    // Of the rows of a photograph read so far (PhotoFile::without_number()).
    long without_number(std::size_t photo) const;
    long transparent(std::size_t photo) const;  // PhotoFile::transparent()

    // Rows a band may have for it to take about `bytes` of memory; at least 1.
    int rows_for(std::size_t bytes) const;

private:
    // Decoded rows of a photograph that the next band may need again.
    struct Rows {
        int y0 = 0, y1 = 0;
        std::vector<float> values;  // as stored, interleaved
    };
    const float* rows_of(std::size_t photo, int y0, int y1);
    class Placement;
    void take_transfer(const Transfer& transfer);
    template <class Decode>
    void resample(std::size_t photo, const Decode& decode, Band& band);
    template <class Decode>
    void read_photo(std::size_t photo, const Decode& decode, std::vector<float>& stored, Band& band);

    const Stack& stack_;
    std::vector<PhotoSource> files_;
    std::vector<Rows> rows_;  // of photographs that are resampled
    std::shared_ptr<BandMemory> memory_ = std::make_shared<BandMemory>();
    std::vector<float> table_;                // linear light of each stored code
    std::optional<Transfer> table_transfer_;  // the curve that table_ was made for
};

}  // namespace tangi
