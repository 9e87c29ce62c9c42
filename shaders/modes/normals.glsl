// normals.glsl: x, y and z of the normals as red, green and blue.
#define SHOWS_MAP

vec3 map_colour(Material m, vec2 at) {
    vec3 n = 0.5 * m.normal + 0.5;
    return pow(n, vec3(2.2));
}
