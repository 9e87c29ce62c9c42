// painting_shader.h: the fragment shader that draws paintings, of the window and of the web page alike.
#pragma once

#include <string>

namespace tangi {

// GLSL without #version and without definitions. It holds the chunks of all view modes; MODE, which is to be
// defined before it with the others, is the number of that which is compiled: its place in view_modes().
// WARD_MODEL is WARD_<name>, or the number, of one of kWardModels.
const std::string& painting_fragment_shader();

}  // namespace tangi
