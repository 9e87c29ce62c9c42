// roughness.glsl: the width of the lobe, alpha [1] in false colours.
#define SHOWS_MAP

vec3 map_colour(Material m, vec2 at) { return false_colour(scaled(m.roughness)); }
