// colour_channels_test.cpp: red, green and blue are told by their names, or there is a message.
#include "capture/photo/colour_channels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tangi {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using Names = std::vector<std::string>;

TEST(ColourChannels, AreFoundByTheirNames) {
    const struct {
        Names names;
        int alpha, first, count;
    } files[] = {{{"R", "G", "B"}, -1, 0, 3},
                 {{"R", "G", "B", "A"}, 3, 0, 3},
                 {{"R", "G", "B", "A", "Z", "n.X", "n.Y"}, 3, 0, 3},
                 {{"Y"}, -1, 0, 1},
                 {{"Y", "A"}, 1, 0, 1},
                 {{"A", "Y"}, 0, 1, 1},
                 {{"450nm"}, -1, 0, 1},  // one band is a grey picture
                 {{"Z", "photo.R", "photo.G", "photo.B"}, -1, 1, 3},
                 {{"red", "green", "blue"}, -1, 0, 3},
                 {{"R", "G", "B", "diffuse.R", "diffuse.G", "diffuse.B"}, -1, 0, 3}};
    for (const auto& [names, alpha, first, count] : files) {
        const ColourChannels found = colour_channels(names, alpha, true);
        EXPECT_EQ(found.first, first) << names.front();
        EXPECT_EQ(found.count, count) << names.front();
        EXPECT_THAT(found.doubt, IsEmpty());
    }
}

TEST(ColourChannels, OfAnotherMeaningAreNotTakenForRedGreenAndBlue) {
    for (const Names& names : {Names{"450", "550", "650"}, Names{"X", "Y", "Z"}, Names{"BY", "RY", "Y"},
                               Names{"450nm", "550nm", "650nm", "750nm", "850nm", "950nm"},
                               Names{"a.R", "a.G", "a.B", "b.R", "b.G", "b.B"}}) {
        const ColourChannels found = colour_channels(names, -1, true);
        EXPECT_EQ(found.count, 0) << names.front();
        EXPECT_THAT(found.doubt, testing::AllOf(HasSubstr(names[0] + ", " + names[1]),
                                                HasSubstr("store red, green and blue")));
    }
}

TEST(ColourChannels, AreShownAsTextWhateverTheirBytesAre) {
    const ColourChannels found = colour_channels({"G", "B", "\xff\n"}, -1, true);
    EXPECT_EQ(found.count, 0);
    EXPECT_THAT(found.doubt, HasSubstr("its channels (G, B, \\xff\\n) do not say"));
}

TEST(ColourChannels, WithoutNamesAreTheFirstOnesOfAFew) {
    const Names unnamed(8, "");
    const auto of = [&](int count, int alpha) {
        return colour_channels(Names(unnamed.begin(), unnamed.begin() + count), alpha, false);
    };
    for (const int count : {1, 3}) EXPECT_EQ(of(count, -1).count, count);
    EXPECT_EQ(of(2, 1).count, 1);
    EXPECT_EQ(of(4, 3).count, 3);
    EXPECT_THAT(of(4, 3).doubt, IsEmpty());
    EXPECT_EQ(of(4, -1).count, 3);
    EXPECT_THAT(of(4, -1).doubt, HasSubstr("its channel 4 is no alpha"));
    EXPECT_THAT(of(2, -1).doubt, HasSubstr("its channel 2 is no alpha"));
    EXPECT_EQ(of(6, 3).count, 0);  // bands of a spectrum; OpenImageIO calls the fourth alpha
    EXPECT_THAT(of(6, 3).doubt, HasSubstr("has 6 channels"));
}

}  // namespace
}  // namespace tangi
