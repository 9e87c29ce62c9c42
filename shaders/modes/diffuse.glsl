// diffuse.glsl: the diffuse albedo rho_d alone, without light and relief.
#define SHOWS_MAP

vec3 map_colour(Material m, vec2 at) { return exposed(m.diffuse); }
