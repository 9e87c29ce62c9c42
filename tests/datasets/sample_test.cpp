// sample_test.cpp: the embedded sample is found, whole, and as its README says.
#include "datasets/sample.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "capture/stack/stack.h"
#include "surface/image_file/image_io.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

// Sets TANGIPAINT_DATASETS, and puts back at the end what it was.
class DatasetsVariable {
public:
    explicit DatasetsVariable(const std::string& value) {
        if (const char* before = std::getenv(kName)) before_ = before;
        ::setenv(kName, value.c_str(), 1);
    }
    ~DatasetsVariable() { before_ ? ::setenv(kName, before_->c_str(), 1) : ::unsetenv(kName); }
    DatasetsVariable(const DatasetsVariable&) = delete;
    DatasetsVariable& operator=(const DatasetsVariable&) = delete;

private:
    static constexpr const char* kName = "TANGIPAINT_DATASETS";
    std::optional<std::string> before_;
};

TEST(Sample, HoldsPhotographsAndHeldOutPhotographsThatOpen) {
    const auto folder = sample_folder() / "impasto" / "jpg";
    const Stack stack = open_stack(folder, {.lights_file = folder / "lights.lp"});
    EXPECT_EQ(stack.photos.size(), 48u);
    EXPECT_EQ(stack.width(), 512);
    EXPECT_EQ(stack.height(), 512);
    const Stack held_out = open_stack(folder, {.lights_file = folder / "heldout.lp"});
    EXPECT_EQ(held_out.photos.size(), 6u);
}

TEST(Sample, HoldsItsTruth) {
    const auto truth = sample_folder() / "impasto" / "gt";
    for (const char* name :
         {"height.exr", "normal.exr", "albedo.exr", "roughness.exr", "specular.exr", "valid.png"})
        EXPECT_EQ(read_picture(truth / name).region(), (Region{0, 0, 512, 512})) << name;
}

TEST(Sample, IsLookedForWhereTheVariableSays) {
    const TestDir elsewhere;
    const DatasetsVariable variable(elsewhere.path().string());
    EXPECT_THAT(error_of([] { sample_folder(); }),
                testing::AllOf(testing::HasSubstr(elsewhere.path().string()),
                               testing::HasSubstr("TANGIPAINT_DATASETS")));
    std::filesystem::create_directories(elsewhere / "impasto");
    EXPECT_EQ(sample_folder(), elsewhere.path());
}

}  // namespace
}  // namespace tangi
