// height.glsl: the height [mm] in false colours.
#define SHOWS_MAP

vec3 map_colour(Material m, vec2 at) { return false_colour(scaled(m.height)); }
