// Fits a stack, saves the painting, and relights it: consumer PHOTOS PAINTING.exr PICTURE.png
#include <array>
#include <iostream>

#include "fit/pipeline/fit_painting.h"
#include "surface/image_file/image_io.h"
#include "surface/painting_file/painting_file.h"
#include "surface/render/relight.h"

int main(int argc, char** argv) try {
    if (argc != 4) throw tangi::Error("usage: consumer PHOTOS PAINTING.exr PICTURE.png");
    const tangi::FitResult fit = tangi::fit_painting(tangi::open_stack(argv[1]));
    tangi::write_painting(argv[2], fit.surface);
    const std::array raking = {tangi::distant_light({-1, 0.2f, 0.3f})};
    tangi::write_picture(argv[3], tangi::relight(fit.surface, raking), {tangi::Transfer::Kind::srgb});
    std::cout << fit.surface.width() << " x " << fit.surface.height() << '\n';
} catch (const tangi::Error& error) {
    std::cerr << "consumer: " << error.what() << '\n';
    return 1;
}
