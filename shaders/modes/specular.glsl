// specular.glsl: the specular albedo, rho_s [1] in false colours.
#define SHOWS_MAP

vec3 map_colour(Material m, vec2 at) { return false_colour(scaled(m.specular)); }
