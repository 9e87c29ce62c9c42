// safe_picture_test.cpp: what is believed of a picture's file before a library opens it: sizes that
// it cannot hold, profiles, EXIF and XMP on which OpenImageIO 2.4 ends the process.
#include "surface/image_file/safe_picture.h"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>

#include <chrono>

#include "surface/image_file/exif_block.h"
#include "surface/image_file/icc_profile.h"
#include "tests/support/capture/picture_metadata.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

Image<Rgb> grey() { return Image<Rgb>(24, 18, Rgb(0.25f)); }

// A profile of one tag, whose size by its header is right.
std::string profile_with_tag(const std::string& name, std::uint64_t offset, std::uint64_t size,
                             const std::string& content) {
    std::string profile =
        srgb_icc_profile().substr(0, 128) + be32(1) + name + be32(offset) + be32(size) + content;
    return be32(profile.size()) + profile.substr(4);
}

std::string png_with_profile(const TestDir& dir, const std::string& profile) {
    write_map(dir / "plain.png", Image<float>(24, 18, 0.25f), {.bits = 8});
    std::string packed = "\x78\x01";  // stored, not packed: RFC 1950, 1951
    packed += '\1' + number_bytes(profile.size(), 2, false) +
              number_bytes(~profile.size() & 0xffff, 2, false) + profile;
    std::uint32_t a = 1, b = 0;
    for (const char c : profile) a = (a + static_cast<unsigned char>(c)) % 65521, b = (b + a) % 65521;
    return with_chunks(bytes_of(dir / "plain.png"),
                       png_chunk_of("iCCP", std::string("mine\0\0", 6) + packed + be32(b << 16 | a)));
}

std::string jpeg_with(const TestDir& dir, const std::string& segments) {
    write_map(dir / "plain.jpg", grey().empty() ? Image<float>() : Image<float>(24, 18, 0.25f));
    return with_segments(bytes_of(dir / "plain.jpg"), segments);
}

std::string profile_segment(const std::string& profile, int number = 1, int count = 1) {
    return jpeg_segment(0xE2, std::string("ICC_PROFILE\0", 12) + static_cast<char>(number) +
                                  static_cast<char>(count) + profile);
}

std::string tiff_with_profile(const std::string& profile) {
    return tiff_with(24, 18, tiff_entry(34675, 7, profile.size(), tiff_values_at(24, 18)), profile);
}

std::string trouble(const std::filesystem::path& path, const std::string& bytes) {
    write_bytes(path, bytes);
    return error_of([&] { read_picture(path); });
}

// Its colours are numbers that a profile explains: without it they are what they were.
TEST(SafePicture, WithADamagedProfileIsReadAsIfItHadNone) {
    const TestDir dir;
    const std::string text = "text" + be32(0) + "hello world, hello";
    const std::vector<std::string> profiles = {
        profile_with_tag("cprt", 0xF0000000, 0x10000010, text),  // whose end is 16 in 32 bits
        profile_with_tag("cprt", 144, 1u << 20, text),
        profile_with_tag("cprt", 144, 7, text),  // shorter than the head of a text
        profile_with_tag("cprt", 144, 11, "desc" + be32(0) + "1234567890"),
        profile_with_tag("cprt", 144, 28,
                         "mluc" + be32(0) + be32(1) + be32(12) + "enUS" + be32(0x40000000) + be32(28))};
    const auto expect_read = [&](const std::string& name, const std::string& bytes, const char* damage) {
        write_bytes(dir / name, bytes);
        const SafePicture safe(dir / name);
        EXPECT_THAT(safe.profile_damage().value_or(""), HasSubstr(damage)) << name;
        const auto input = OIIO::ImageInput::open(safe.path());
        ASSERT_TRUE(input) << name;
        EXPECT_FALSE(input->spec().find_attribute("ICCProfile")) << name;
        EXPECT_NEAR(read_picture(dir / name)(3, 4).g, 0.25f, 0.01f) << name;
    };
    for (const std::string& profile : profiles) {
        expect_read("a.jpg", jpeg_with(dir, profile_segment(profile)), "tag 'cprt'");
        expect_read("a.tif", tiff_with_profile(profile), "tag 'cprt'");
        expect_read("a.png", png_with_profile(dir, profile), "tag 'cprt'");
    }
    // Behind a segment that says that it is shorter than its own length.
    for (const char* before : {"\xFF\xE0\0", "\xFF\xE1\0", "\xFF\xFE\0"})
        for (const char length : {'\0', '\1'})
            expect_read("a.jpg",
                        jpeg_with(dir, std::string(before, 3) + length + profile_segment(profiles.back())),
                        "tag 'cprt'");
    expect_read("a.jpg", jpeg_with(dir, profile_segment(srgb_icc_profile(), 1, 2)),
                "its part 2 of 2 is missing");
    expect_read("a.tif", tiff_with(24, 18, tiff_entry(34675, 7, 3000, 1u << 20), ""),
                "it lies outside of the file");
}

TEST(SafePicture, WithASoundProfileIsOpenedAsItIs) {
    const TestDir dir;
    write_bytes(dir / "a.jpg", jpeg_with(dir, profile_segment(srgb_icc_profile())));
    write_bytes(dir / "a.tif", tiff_with_profile(srgb_icc_profile()));
    write_bytes(dir / "a.png", png_with_profile(dir, srgb_icc_profile()));
    for (const char* name : {"a.jpg", "a.tif", "a.png"}) {
        EXPECT_EQ(SafePicture(dir / name).path(), (dir / name).string());
        EXPECT_EQ(SafePicture(dir / name).profile_damage(), std::nullopt) << name;
        EXPECT_NEAR(read_picture(dir / name)(3, 4).g, 0.25f, 0.01f) << name;
    }
    EXPECT_EQ(damage_of_icc(srgb_icc_profile()), std::nullopt);
    EXPECT_EQ(damage_of_icc("no profile at all"), std::nullopt);
}

// Every tag, with every number of its entry at its worst.
TEST(SafePicture, FindsAnyTagThatLiesOutside) {
    const std::string sound = srgb_icc_profile();
    for (std::size_t entry = 132; entry < 132 + 10 * 12; entry += 12)
        for (const std::size_t number : {4u, 8u})
            for (const std::uint64_t value : {0xffffffffull, 0x80000000ull, 0x100000ull}) {
                std::string damaged = sound;
                damaged.replace(entry + number, 4, be32(value));
                EXPECT_TRUE(damage_of_icc(damaged)) << entry << ", " << value;
            }
    std::string many = sound;
    many.replace(128, 4, be32(0x20000000));
    EXPECT_TRUE(damage_of_icc(many));
}

TEST(SafePicture, HidesExifThatLeadsBackToItselfAndKeepsWhatIsSound) {
    const TestDir dir;
    ASSERT_TRUE(is_sound_exif(plain_exif()));
    ASSERT_FALSE(is_sound_exif(exif_in_a_circle()));
    write_map(dir / "plain.png", Image<float>(24, 18, 0.25f), {.bits = 8});
    write_bytes(dir / "a.png",
                with_chunks(bytes_of(dir / "plain.png"), png_chunk_of("eXIf", exif_in_a_circle())));
    write_bytes(dir / "a.jpg", jpeg_with(dir, exif_segment(exif_in_a_circle())));
    for (const char* name : {"a.png", "a.jpg"}) {
        const SafePicture safe(dir / name);
        EXPECT_NE(safe.path(), (dir / name).string());
        const auto input = OIIO::ImageInput::create(safe.reader());
        OIIO::ImageSpec spec;
        ASSERT_TRUE(input->open(safe.path(), spec)) << name << input->geterror();
        EXPECT_NEAR(spec.get_float_attribute("ExposureTime"), 0.02f, 1e-6f) << name;
        EXPECT_NEAR(spec.get_float_attribute("FNumber"), 8, 1e-6f) << name;
        EXPECT_EQ(spec.get_string_attribute("Make"), "Canon") << name;
        EXPECT_NEAR(read_picture(dir / name)(3, 4).g, 0.25f, 0.01f) << name;
    }
}

// A law: whatever is done to a block, what is kept of it is sound.
TEST(SafePicture, KeepsOnlySoundExif) {
    Random random(3);
    for (int i = 0; i < 20'000; ++i) {
        std::string block = i % 2 == 0 ? plain_exif() : exif_in_a_circle();
        for (int times = random.below(6); times > 0; --times)
            block[static_cast<std::size_t>(random.below(static_cast<int>(block.size())))] =
                static_cast<char>(random.below(256));
        block.resize(block.size() - static_cast<std::size_t>(random.below(3) * random.below(60)));
        const std::string kept = sound_part_of_exif(block);
        EXPECT_TRUE(kept.empty() || is_sound_exif(kept)) << i;
        EXPECT_LT(kept.size(), 65'000u);
    }
}

TEST(SafePicture, HidesXmpThatIsNestedWithoutEnd) {
    const TestDir dir;
    constexpr std::size_t deep = 9000;  // 63 kB, of which a JPEG segment holds 64; a TIFF tag holds any
    const std::string xmp = xmp_of(nest(deep));
    write_bytes(dir / "a.jpg", jpeg_with(dir, xmp_segment(xmp)));
    write_map(dir / "plain.png", Image<float>(24, 18, 0.25f), {.bits = 8});
    const std::string large = xmp_of(nest(400'000));
    write_bytes(dir / "a.png",
                with_chunks(bytes_of(dir / "plain.png"),
                            png_chunk_of("iTXt", std::string("XML:com.adobe.xmp\0\0\0\0\0", 22) + large)));
    write_bytes(dir / "a.tif",
                tiff_with(24, 18, tiff_entry(700, 1, large.size(), tiff_values_at(24, 18)), large));
    for (const char* name : {"a.jpg", "a.png", "a.tif"}) {
        EXPECT_NE(SafePicture(dir / name).path(), (dir / name).string()) << name;
        EXPECT_NEAR(read_picture(dir / name)(3, 4).g, 0.25f, 0.01f) << name;
    }
}

// Segments shorter than what OpenImageIO reads of them; behind the first scan of several, too.
TEST(SafePicture, HidesSegmentsThatAreShorterThanTheirHeads) {
    const TestDir dir;
    for (const std::string& segment :
         {jpeg_segment(0xE2, std::string("ICC_PROFILE\0", 12)), jpeg_segment(0xE1, std::string("Exif\0", 5)),
          jpeg_segment(0xED, std::string("Photoshop 3.0\0", 14)), jpeg_segment(0xE1, "Exi"),
          jpeg_segment(0xED, std::string("Photoshop 3.0\0"
                                         "8BIM\x04\x04\0\0\0\0\xff\xff",
                                         26))}) {
        write_bytes(dir / "a.jpg", jpeg_with(dir, segment));
        EXPECT_NE(SafePicture(dir / "a.jpg").path(), (dir / "a.jpg").string());
        EXPECT_NEAR(read_picture(dir / "a.jpg")(3, 4).g, 0.25f, 0.01f);
    }
}

std::string png_of_size(std::uint64_t width, std::uint64_t height) {
    return "\x89PNG\r\n\x1a\n" +
           png_chunk_of("IHDR", be32(width) + be32(height) + std::string("\x08\x02\0\0\0", 5)) +
           png_chunk_of("IDAT", std::string("\x78\x9c\x03\0\0\0\0\1", 8)) + png_chunk_of("IEND", "");
}

TEST(SafePicture, ThatClaimsMoreThanItCanHoldIsAnErrorAtOnce) {
    const TestDir dir;
    const auto begin = std::chrono::steady_clock::now();
    const auto says = AllOf(HasSubstr("is damaged: it says that it has "), HasSubstr("bytes cannot hold"));
    for (const std::uint64_t side : {3000u, 30'000u, 65'535u, 1'000'000u})
        EXPECT_THAT(
            trouble(dir / "a.png", png_of_size(side, side)),
            AllOf(StartsWith((dir / "a.png").string()), says, HasSubstr(fmt::format("{0} x {0}", side))));
    std::string jpeg = jpeg_with(dir, "");
    const std::size_t frame = jpeg.find("\xFF\xC0");
    ASSERT_NE(frame, std::string::npos);
    jpeg.replace(frame + 5, 4, "\xFF\xDC\xFF\xDC");
    EXPECT_THAT(trouble(dir / "a.jpg", jpeg), says);
    std::string tiff = tiff_with(24, 18, "", "");
    const std::size_t width = tiff.find(tiff_entry(256, 3, 1, 24));
    ASSERT_NE(width, std::string::npos);
    tiff.replace(width, 12, tiff_entry(256, 4, 1, 60'000));
    EXPECT_THAT(trouble(dir / "a.tif", tiff), says);
    write_bytes(dir / "a.tga", std::string("\0\0\2\0\0\0\0\0\0\0\0\0\xff\xff\xff\xff\x18\0", 18));
    EXPECT_THAT(error_of([&] { read_picture(dir / "a.tga"); }), says);
    std::string bmp =
        "BM" + std::string(12, '\0') + std::string("\x28\0\0\0\xff\xff\0\0\xff\xff\0\0\1\0\x18\0", 16);
    write_bytes(dir / "a.bmp", bmp + std::string(200, '\0'));
    EXPECT_THAT(error_of([&] { read_picture(dir / "a.bmp"); }), says);
    const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    EXPECT_LT(took_s, 2);
}

// Pictures of one colour, each as small as its format makes it, are none of these.
TEST(SafePicture, OfOneColourIsNotTooShort) {
    const TestDir dir;
    const struct {
        const char *name, *compression;
    } files[] = {{"a.png", "zip:9"},    {"a.jpg", "jpeg:1"}, {"a.tif", "zip:9"}, {"b.tif", "lzw"},
                 {"c.tif", "packbits"}, {"a.tga", "rle"},    {"a.exr", "zip"},   {"b.exr", "rle"},
                 {"c.exr", "piz"},      {"d.exr", "pxr24"},  {"e.exr", "b44a"},  {"f.exr", "dwab"},
                 {"g.exr", "zips"},     {"a.bmp", "none"}};
    for (const auto& [name, compression] : files)
        for (const bool tiled : {false, true}) {
            if (tiled && std::string(name).find(".exr") == std::string::npos &&
                std::string(name).find(".tif") == std::string::npos)
                continue;
            const bool is_exr = lower_extension(name) == ".exr";
            OIIO::ImageSpec spec(2000, 1500, 3, is_exr ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::UINT8);
            spec.attribute("compression", compression);
            if (tiled) spec.tile_width = spec.tile_height = 256;
            const auto output = OIIO::ImageOutput::create((dir / name).string());
            ASSERT_TRUE(output->open((dir / name).string(), spec)) << name;
            const std::vector<float> black(2000 * 1500 * 3, 0.0f);
            ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, black.data())) << name;
            ASSERT_TRUE(output->close());
            EXPECT_EQ(read_picture(dir / name).width(), 2000) << name << (tiled ? ", tiled" : "");
        }
}

TEST(SafePicture, IsReadByItsContentAndNothingElseIs) {
    const TestDir dir;
    write_picture(dir / "a.png", grey(), kSrgb);
    std::filesystem::copy_file(dir / "a.png", dir / "b.jpg");
    EXPECT_STREQ(SafePicture(dir / "b.jpg").reader(), "png");
    EXPECT_EQ(read_picture(dir / "b.jpg").width(), 24);
    EXPECT_THAT(
        trouble(dir / "c.png", "\x01\x02 no picture"),
        HasSubstr(
            "c.png: is not a picture that can be read: it is no PNG, JPEG, TIFF, EXR, TGA or BMP file"));
}

// The system gives no bytes of /proc/self/mem at its beginning (EIO), as of a disk that fails.
TEST(SafePicture, OnADiskThatFailsIsNotCalledDamaged) {
    EXPECT_EQ(trouble_with_pixels("/proc/self/mem", "Premature end of file"), "Input/output error");
    EXPECT_EQ(trouble_with_picture("/proc/self/mem", "Could not open"), "Input/output error");
}

}  // namespace
}  // namespace tangi
