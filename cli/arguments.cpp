#include "cli/arguments.h"

#include <sstream>

#include "cli/command.h"
#include "surface/error.h"

namespace tangi {

namespace {

std::vector<double> numbers_of(const std::string& text, const std::string& flag, std::size_t count,
                               const std::string& form) {
    std::vector<double> numbers;
    std::istringstream stream(text);
    for (std::string word; std::getline(stream, word, ',');) {
        std::size_t used = 0;
        double value = 0;
        try {
            value = std::stod(word, &used);
        } catch (const std::exception&) {
            used = std::string::npos;
        }
        if (used != word.size() || !std::isfinite(value))
            throw UsageError(fmt::format("{} {}: '{}' is not a number; expected {}", flag, text, word, form));
        numbers.push_back(value);
    }
    if (numbers.size() != count) throw UsageError(fmt::format("{} {}: expected {}", flag, text, form));
    return numbers;
}

}  // namespace

void PhotosArguments::add_to(CLI::App& app, bool for_fit) {
    app.add_option("PHOTOS", folder, "folder of photographs, one for each light")->required();
    app.add_option("--lights", lights, "lights file (.lp); where not given, the only one in the folder");
    app.add_option("--transfer", transfer,
                   "how the photographs are encoded: auto, linear, srgb, or a gamma such as 2.2")
        ->capture_default_str();
    app.add_option("--crop", crop, "only a part of the photographs: X,Y,WIDTH,HEIGHT in pixels");
    app.add_option("--mask", mask, "picture of the same size; what is black in it is left out");
    if (!for_fit) return;
    app.add_option("--hold-out", hold_out,
                   "keep photographs from the fit, to compare with: positions from 0, START:STEP or names, "
                   "separated by commas");
}

Stack PhotosArguments::open() const {
    StackOptions options;
    if (!lights.empty()) options.lights_file = lights;
    if (!mask.empty()) options.mask_file = mask;
    if (!crop.empty()) {
        const auto n = numbers_of(crop, "--crop", 4, "X,Y,WIDTH,HEIGHT");
        const auto pixel = [&](double value) {
            if (value != std::floor(value) || std::abs(value) > 1e6)
                throw UsageError(fmt::format("--crop {}: pixels are whole numbers", crop));
            return static_cast<int>(value);
        };
        options.crop = Region{pixel(n[0]), pixel(n[1]), pixel(n[0]) + pixel(n[2]), pixel(n[1]) + pixel(n[3])};
    }
    if (transfer != "auto") {
        options.transfer = transfer_named(transfer);
        if (!options.transfer)
            throw UsageError(
                fmt::format("--transfer {}: is not auto, linear, srgb, or a gamma in [0.2, 5]", transfer));
    }
    Stack stack = open_stack(folder, options);
    if (!hold_out.empty()) tangi::hold_out(stack, hold_out);
    return stack;
}

Vec3 parse_vector(const std::string& text, const std::string& flag) {
    const auto n = numbers_of(text, flag, 3, "X,Y,Z");
    return {static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])};
}

nlohmann::json told(const std::vector<std::string>& warnings) {
    for (const std::string& warning : warnings) warn(warning);
    return warnings;
}

}  // namespace tangi
