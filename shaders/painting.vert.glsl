// painting.vert.glsl: one triangle over the whole picture, and what all of its pixels have in common (picture.glsl).

uniform mat3 u_to_painting;  // gl_FragCoord.xy, 1 -> pixel of the painting times its third component
uniform vec4 u_viewport;     // left, bottom, width, height [pixels of the target]
uniform mat3 u_exposure;     // of the linear picture
uniform vec4 u_eye;          // direction to the viewer [unit vector]; EYE == 1: place [mm]
uniform float u_ambient, u_rig_ambient;
uniform float u_shoulder;    // [1] 0: clips at white; else where the tone curve leaves the straight line
uniform vec3 u_background;   // [linear]
uniform vec4 u_look;         // strengths of the mode; heights' false colour: lowest, highest [mm]
uniform vec2 u_reflectance_model;          // diffuse roughness [1], second lobe [1]
uniform float u_mm_per_pixel;
uniform float u_bend;          // [1/mm]
uniform float u_light_radius;  // [rad]
uniform float u_highest;       // [mm]
uniform vec4 u_light[LIGHTS];  // direction [unit vector], 0; or position [mm], 1
uniform vec3 u_gain[LIGHTS];
uniform vec2 u_place[LIGHTS];  // of far lights: azimuth [turns], elevation [rad]
uniform ivec2 u_size;          // [pixels] of the painting
uniform int u_level;           // of detail: texels of 2^level pixels
uniform int u_last_level;      // the coarsest
uniform int u_first_page[32];  // surface.glsl
uniform ivec4 u_homes;
uniform vec4 u_range;          // largest rho_d, largest rho_s; lowest height [mm], heights' range [mm]

STRAIGHT out vec3 v_place;  // as u_to_painting gives it

void main() {
    v_scene = vec3(u_mm_per_pixel, u_ambient, u_rig_ambient);
    v_exposure0 = vec4(u_exposure[0], u_shoulder);
#if SHADOWS == 2
    v_exposure1 = vec4(u_exposure[1], u_light_radius);
#else
    v_exposure1 = vec4(u_exposure[1], 1.0 / max(u_light_radius, 1e-4));
#endif
    v_exposure2 = vec4(u_exposure[2], u_bend);
    v_eye = vec4(u_eye.xyz, u_highest);
    v_range = u_range;
    v_background = vec4(u_background, u_reflectance_model.x);
    v_look = u_look;
#if NEAR == 1
    v_light = u_light[0];
#else
    v_light = vec4(u_light[0].xyz, 1.0 / float(u_size.y));
#endif
    v_light_gain = vec4(u_gain[0], u_place[0].x);
    v_rest = vec4(u_reflectance_model.y, u_place[0].y, exp2(-float(u_level)), 1.0 / float(u_size.x));
    v_size = ivec4(u_size, u_level, u_last_level);
#if AT_HOME == 1
    v_tiles = u_homes;
#else
    v_tiles = ivec4(u_first_page[u_level], (((u_size.x + (1 << u_level) - 1) >> u_level) + 255) >> 8, 0, 0);
#endif
    vec2 corner = vec2(float(gl_VertexID & 1) * 4.0 - 1.0, float(gl_VertexID >> 1) * 4.0 - 1.0);
    v_place = u_to_painting * vec3(u_viewport.xy + (0.5 * corner + 0.5) * u_viewport.zw, 1.0);
    gl_Position = vec4(corner, 0.0, 1.0);
}
