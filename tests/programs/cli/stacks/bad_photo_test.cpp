// Everything that can be wrong with photographs: the message names the file, the place, the remedy.
#include "tests/programs/support/bad_stack.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;

// Uncompressed, rows from the bottom up, blue first (Truevision TGA 2.0, image type 2).
void write_tga(const fs::path& path, const Image<Rgb>& picture) {
    std::string bytes(18, '\0');
    bytes[2] = 2, bytes[16] = 24;
    bytes[12] = static_cast<char>(picture.width()), bytes[14] = static_cast<char>(picture.height());
    for (int y = picture.height() - 1; y >= 0; --y)
        for (int x = 0; x < picture.width(); ++x)
            for (int c = 2; c >= 0; --c)
                bytes += static_cast<char>(std::lround(255 * std::clamp(picture(x, y)[c], 0.0f, 1.0f)));
    write_bytes(path, bytes);
}

TEST(CliBadPhoto, HasAnotherSize) {
    const TinyStack stack;
    write_picture(stack.photo(4), Image<Rgb>(32, 31, Rgb(0.5f)), Transfer{});
    const auto result = expect_warned(
        stack, {stack.name(4) + ": is 32 x 31", "img_000.png is 32 x 32", "the same size; rejected"});
    EXPECT_EQ(result["photographs"]["fitted"], 11);
    EXPECT_EQ(names_rejected(result), std::vector<std::string>{stack.name(4)});
    // What most have is right, not what the first has.
    fs::copy_file(stack.photo(3), stack.photo(4), fs::copy_options::overwrite_existing);
    write_picture(stack.photo(0), Image<Rgb>(32, 31, Rgb(0.5f)), Transfer{});
    expect_warned(stack, {stack.name(0) + ": is 32 x 31"});
    fs::remove(stack.out("a.exr"));
    for (const int i : {0, 2, 4, 6}) write_picture(stack.photo(i), Image<Rgb>(32, 31, Rgb(0.5f)), Transfer{});
    expect_refused(stack, {"the same size", "4 of 12", "too many to go on without"});
}

TEST(CliBadPhoto, IsGreyAmongColour) {
    const TinyStack stack;
    write_map(stack.photo(6), Image<float>(32, 32, 0.5f));
    expect_warned(stack,
                  {stack.name(6) + ": is 32 x 32, grey", "img_000.png is 32 x 32, colour", "convert it"});
}

TEST(CliBadPhoto, HasAnotherDepth) {
    const TinyStack stack;
    write_picture(stack.photo(6), Image<Rgb>(32, 32, Rgb(0.5f)), Transfer{}, {.bits = 8});
    expect_warned(stack, {stack.name(6) + ": has 8 bits a sample, but img_000.png has 16", "stored alike"});
}

TEST(CliBadPhoto, IsATruncatedJpeg) {
    const TinyStack stack([](GeneratorOptions& o) { o.format = GeneratorFormat::jpg; });
    // Linear light in JPEG files is unusual enough for few lights to leave it in doubt.
    const std::vector<std::string> as_stored = {"--transfer", "linear"};
    const std::string whole = bytes_of(stack.photo(2));
    for (const std::size_t kept : {whole.size() - 2, whole.size() - 100, whole.size() * 9 / 10}) {
        write_bytes(stack.photo(2), whole.substr(0, kept));
        expect_warned(stack, {stack.name(2), "truncated", "copy it again"}, as_stored);
    }
    write_bytes(stack.photo(2), whole.substr(0, 300));  // not even all of its header
    expect_warned(stack, {stack.name(2), "is not a picture", "as if cut off"}, as_stored);
    write_bytes(stack.photo(2), "");
    expect_warned(stack, {stack.name(2), "is not a picture"}, as_stored);
}

TEST(CliBadPhoto, IsTruncatedInAnyFormat) {
    for (const GeneratorFormat format :
         {GeneratorFormat::png16, GeneratorFormat::tif, GeneratorFormat::exr}) {
        const TinyStack stack([&](GeneratorOptions& o) { o.format = format; });
        const std::string whole = bytes_of(stack.photo(2));
        write_bytes(stack.photo(2), whole.substr(0, whole.size() * 2 / 3));
        SCOPED_TRACE(name_of(format));
        const auto result = expect_warned(stack, {stack.name(2), "rejected"});
        EXPECT_EQ(result["photographs"]["fitted"], 11);
        EXPECT_EQ(names_rejected(result), std::vector<std::string>{stack.name(2)});
        fs::remove(stack.out("a.exr"));
        for (const int i : {0, 4, 6})
            fs::copy_file(stack.photo(2), stack.photo(i), fs::copy_options::overwrite_existing);
        expect_refused(stack, {"too many to go on without"});
    }
}

// What only shows when pixels are decoded: the header is whole.
TEST(CliBadPhoto, HasDamagedPixels) {
    const TinyStack png;
    std::string bytes = bytes_of(png.photo(2));
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x55);
    write_bytes(png.photo(2), bytes);
    const auto result = expect_warned(png, {png.name(2), "cannot be decoded", "rejected"});
    EXPECT_EQ(result["photographs"]["fitted"], 11);
    EXPECT_EQ(names_rejected(result), std::vector<std::string>{png.name(2)});
    EXPECT_TRUE(ended(tangipaint({"fit", png.path(), "--out", png.out("a.exr"), "--hold-out", "3,5",
                                  "--residual", "--report", png.out("a.html")}),
                      0, {png.name(2)}));
    EXPECT_NE(bytes_of(png.out("a.html")).find(png.name(2) + ": cannot be decoded"), std::string::npos);

    const Finished compared = tangipaint({"compare", png.out("a.exr"), png.path(), "--out", png.out("c")});
    ASSERT_TRUE(ended(compared, 0, {png.name(2), "rejected"}));
    EXPECT_EQ(compared.json()["mean"]["all"]["count"], 11);

    const TinyStack tga;
    for (int i = 0; i < 12; ++i) {
        const Image<Rgb> photo = read_picture(tga.photo(i));
        fs::remove(tga.photo(i));
        write_tga(fs::path(tga.photo(i)).replace_extension(".tga"), photo);
    }
    const std::string second = fs::path(tga.photo(2)).replace_extension(".tga");
    write_bytes(second, bytes_of(second).substr(0, 1500));
    EXPECT_EQ(
        expect_warned(tga, {second, "is damaged", "copy it again", "rejected"})["photographs"]["fitted"], 11);
}

// The same picture twice: whichever light is right, the other is not.
TEST(CliBadPhoto, IsACopyOfAnother) {
    const TinyStack stack;
    fs::copy_file(stack.photo(3), stack.photo(7), fs::copy_options::overwrite_existing);
    const auto result =
        expect_warned(stack, {stack.name(3) + ", " + stack.name(7) + " are the same picture", "rejected"});
    EXPECT_EQ(result["photographs"]["fitted"], 10);
    fs::remove(stack.out("a.exr"));
    for (int i = 0; i < 12; ++i)
        if (i != 3) fs::copy_file(stack.photo(3), stack.photo(i), fs::copy_options::overwrite_existing);
    expect_refused(stack, {stack.path(), "all 12 photographs are the same picture"});
}

TEST(CliBadPhoto, IsACopyOfAnotherWhereAPaintingIsCompared) {
    const TinyStack stack;
    ASSERT_TRUE(ended(tangipaint({"fit", stack.path(), "--out", stack.out("a.exr")}), 0));
    fs::copy_file(stack.photo(3), stack.photo(7), fs::copy_options::overwrite_existing);
    const Finished run = tangipaint({"compare", stack.out("a.exr"), stack.path(), "--out", stack.out("c")});
    ASSERT_TRUE(ended(run, 0, {stack.name(3) + ", " + stack.name(7) + " are the same picture", "rejected"}));
    EXPECT_EQ(run.json()["photos"].size(), 10u);
    EXPECT_EQ(run.json()["rejected"].size(), 2u);
}

// Another part of the same size looks like a bad fit.
TEST(CliBadPhoto, IsComparedInAnotherPartThanWasFitted) {
    const TinyStack stack({}, 48);
    const std::string painting = stack.out("a.exr");
    ASSERT_TRUE(ended(tangipaint({"fit", stack.path(), "--out", painting, "--crop", "0,0,32,32"}), 0));
    const auto compared = [&](std::vector<std::string> crop) {
        crop.insert(crop.begin(), {"compare", painting, stack.path(), "--out", stack.out("c")});
        return tangipaint(crop);
    };
    const Finished same = compared({"--crop", "0,0,32,32"}), remembered = compared({});
    ASSERT_TRUE(ended(same, 0));
    ASSERT_TRUE(ended(remembered, 0));  // that part, without a word
    EXPECT_EQ(remembered.json()["mean"], same.json()["mean"]);
    EXPECT_TRUE(ended(compared({"--crop", "16,16,32,32"}), 3,
                      {"--crop 16,16,32,32 is another part", "--crop 0,0,32,32", "leave --crop out"}));
}

TEST(CliBadPhoto, IsBlack) {
    const TinyStack stack;
    write_picture(stack.photo(1), Image<Rgb>(32, 32), Transfer{});
    const auto result =
        expect_warned(stack, {stack.path(), "rejected 1 photograph that is black", stack.name(1)});
    EXPECT_EQ(result["photographs"]["fitted"], 11);
    for (int i = 0; i < 12; ++i) write_picture(stack.photo(i), Image<Rgb>(32, 32), Transfer{});
    fs::remove(stack.out("a.exr"));
    expect_refused(stack, {"photographs are black"});
}

TEST(CliBadPhoto, IsAFolderOrAText) {
    const TinyStack stack;
    write_bytes(stack.photo(2), "this is no picture");
    expect_warned(stack, {stack.name(2), "is not a picture that can be read"});
    fs::remove(stack.photo(2));
    fs::create_directory(stack.photo(2));
    expect_warned(stack, {stack.name(2)});
}

// Archives from Windows bring names in the code page of their day.
TEST(CliBadPhoto, HasANameThatIsNotUnicode) {
    const TinyStack stack;
    const std::string name = "caf\xe9 1.png";
    fs::rename(stack.photo(2), fs::path(stack.path()) / name);
    stack.change_lights([&](auto& lines) { lines[3].replace(0, stack.name(2).size(), name); });
    const Finished fit = tangipaint({"fit", stack.path(), "--out", stack.out("a.exr"), "--hold-out", "0"});
    ASSERT_TRUE(ended(fit, 0));
    EXPECT_EQ(fit.json()["photographs"]["fitted"], 11);
    const Finished compared =
        tangipaint({"compare", stack.out("a.exr"), stack.path(), "--out", stack.out("c")});
    ASSERT_TRUE(ended(compared, 0));
    EXPECT_EQ(compared.json()["mean"]["fitted"]["count"], 11);  // it is known by its name
    ASSERT_TRUE(ended(tangipaint({"info", stack.out("a.exr")}), 0));
    EXPECT_TRUE(ended(
        tangipaint({"relight", stack.out("a.exr"), "--lights", stack.lights(), "--out", stack.out("d")}), 0));
    EXPECT_TRUE(fs::exists(fs::path(stack.out("d")) / name));
}

}  // namespace
}  // namespace tangi
