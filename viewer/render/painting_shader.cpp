#include "viewer/render/painting_shader.h"

#include <fmt/format.h>

#include "surface/reflectance/ward.h"
#include "viewer/render/fragment_shader_begin.h"
#include "viewer/render/fragment_shader_end.h"
#include "viewer/render/view_mode.h"

namespace tangi {

namespace {

std::string assembled() {
    std::string text;
    for (const WardModelTraits& model : kWardModels)
        text += fmt::format("#define WARD_{} {}\n", model.name, static_cast<int>(model.model));
    text += kFragmentShaderBegin;
    for (const ViewModeTraits& mode : view_modes())
        text += fmt::format("#if MODE == {}\n{}{}#endif\n", static_cast<int>(mode.mode),
                            scale_chunk(mode.scale), mode.chunk);
    return text + kFragmentShaderEnd;
}

}  // namespace

const std::string& painting_fragment_shader() {
    static const std::string text = assembled();
    return text;
}

}  // namespace tangi
