// light.glsl: where light comes from, and what of it the relief keeps off; mirrors surface/maps/light.cpp and relight.cpp.
// LIGHTS: their number; NEAR: 1 where some are near; BENDS: 1 where the rig's directions turn over the picture;
// BEAMS: 1 where the lights are uneven by themselves;
// SHADOWS: 0 none, 1 horizon map, 2 marched over the heights as surface/render/cast_shadows.cpp does, 3 horizons in the directions
// of far lights, which are all the same: two directions of the map were mixed beforehand, once for all pixels.
// Software renderers go through both sides of every branch: what is the same for all pixels is decided beforehand.

uniform vec4 u_light[LIGHTS];  // direction [unit vector], 0; or position [mm], 1
uniform vec3 u_gain[LIGHTS];
uniform vec2 u_place[LIGHTS];  // of far lights: azimuth [turns], elevation [rad]
#if BEAMS == 1
uniform vec2 u_beam[LIGHTS];         // [1/mm] x, y of ln irradiance
uniform vec3 u_beam_curved[LIGHTS];  // [1/mm^2] x^2, x y, y^2
#endif
uniform mediump sampler3D u_horizon;  // [1] elevation of the horizon: value^2 * pi/2; x, y, azimuth
#if SHADOWS == 3
uniform highp sampler2DArray u_light_horizon;  // the same; x, y, light
#endif

vec4 light(int i) { return i == 0 ? v_light : u_light[i]; }
vec3 gain(int i) { return i == 0 ? v_light_gain.xyz : u_gain[i]; }
vec2 place(int i) { return i == 0 ? vec2(v_light_gain.w, v_rest.y) : u_place[i]; }

struct Incoming {
    vec3 direction;  // [unit vector]
    vec3 irradiance;
};

vec3 point_mm(vec2 at, float height) {
    vec2 centred = at - 0.5 * vec2(v_size.xy - 1);
    return vec3(centred.x * v_scene.x, -centred.y * v_scene.x, height);
}

vec3 bent(vec3 v, vec3 point) {
#if BENDS == 1
    vec2 r = v_exposure2.w * point.xy;
    vec3 turned = vec3(v.xy + r * v.z, v.z - dot(r, v.xy));
    return turned * (length(v) / length(turned));
#else
    return v;
#endif
}

vec3 gain_at(int i, vec3 point) {
#if BEAMS == 1
    vec2 p = point.xy;
    return gain(i) * exp(dot(u_beam[i], p) + dot(u_beam_curved[i], vec3(p.x * p.x, p.x * p.y, p.y * p.y)));
#else
    return gain(i);
#endif
}

Incoming incoming(int i, vec3 point) {
    vec4 source = light(i);
    vec3 from = bent(source.xyz, point);
#if NEAR == 1
    vec3 to_light = source.w == 0.0 ? from : from - point;
    float distance2 = dot(to_light, to_light);
    return Incoming(to_light * inversesqrt(distance2), gain_at(i, point) * (dot(from, from) / distance2));
#else
    return Incoming(from, gain_at(i, point));
#endif
}

const float kPi = 3.14159265358979;

#if SHADOWS == 1 || SHADOWS == 3
// Part of a disc of the radius 1 / v_exposure1.w around `elevation` that stands above the horizon [rad]: the odd polynomial with the
// slope of the true area in the middle and 0 at the rims, wrong by 0.008 at most.
float above(float horizon, float elevation) {
    float covered = clamp((horizon - elevation) * v_exposure1.w, -1.0, 1.0);
    float covered2 = covered * covered;
    return 0.5 - covered * (0.63662 - covered2 * (0.02324 + 0.11338 * covered2));
}
#elif SHADOWS == 2
float height_between(vec2 at) {
    ivec2 i = min(ivec2(at), v_size.xy - 2);
    vec2 f = at - vec2(i);
    float a = height_in(texel_at(i, 0)), b = height_in(texel_at(i + ivec2(1, 0), 0));
    float c = height_in(texel_at(i + ivec2(0, 1), 0)), d = height_in(texel_at(i + 1, 0));
    return mix(mix(a, b, f.x), mix(c, d, f.x), f.y);
}

bool inside(vec2 p) { return p.x >= 0.0 && p.y >= 0.0 && p.x <= float(v_size.x - 1) && p.y <= float(v_size.y - 1); }

// Half of what the light's line rises within a pixel against ground of this slope [pixels].
float half_width(vec3 direction, float across, float slope) { return 0.5 * max(direction.z - slope * across, 0.0); }
#endif

// Of light i, which comes from `direction`.
float visibility(int i, vec2 at, float height, vec3 direction) {
#if SHADOWS == 0
    return 1.0;
#elif SHADOWS == 3
    float root = texture(u_light_horizon, vec3((at + 0.5) * vec2(v_rest.w, v_light.w), float(i))).r;
    return above(root * root * (0.5 * kPi), place(i).y);
#elif SHADOWS == 1
#if NEAR == 1 || BENDS == 1
    float across = length(direction.xy);
    vec2 from = vec2(across > 1e-6 ? atan(direction.y, direction.x) / (2.0 * kPi) : 0.0, atan(direction.z, across));
#else
    vec2 from = place(i);
#endif
    vec2 uv = (at + 0.5) / vec2(v_size.xy);
    float root = texture(u_horizon, vec3(uv, from.x + 0.5 / 16.0)).r;
    return above(root * root * (0.5 * kPi), from.y);
#else
    float across = length(direction.xy);
    if (across < 1e-6) return 1.0;
    vec2 step_px = vec2(direction.x, -direction.y) / across;
    if (!inside(at + step_px)) return 1.0;
    float radius = tan(v_exposure1.w);
    float before = half_width(direction, across, (height_between(at + step_px) - height) / v_scene.x), behind = before;
    if (inside(at - step_px)) behind = half_width(direction, across, (height - height_between(at - step_px)) / v_scene.x);
    float covered = -1.0, highest = (v_eye.w - height) / v_scene.x;
    for (float t = 1.0; covered < 1.0; t += 1.0) {
        float lean = covered * radius;
        bool matters = direction.z + lean * across < 0.0 ||
                       highest * (across - lean * direction.z) >
                       t * (direction.z + lean * across) - max(-covered, 0.0) * before;
        vec2 p = at + t * step_px;
        if (!matters || !inside(p)) break;
        float rise = (height_between(p) - height) / v_scene.x;
        float far = radius * max(rise * direction.z + t * across, 0.0);
        float above = rise * across - t * direction.z, width = above < 0.0 ? before : behind;
        covered = max(covered, above / max(sqrt(far * far + width * width), 1e-6));
    }
    if (covered >= 1.0) return 0.0;
    return clamp((acos(covered) - covered * sqrt(max(1.0 - covered * covered, 0.0))) / kPi, 0.0, 1.0);
#endif
}
