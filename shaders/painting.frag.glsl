// painting.frag.glsl: what a painting looks like under its lights, or one of its maps. Values as relight() in
// surface/render/relight.h:
//   value = ambient rho_d + sum over lights of irradiance *
//           (visibility (rho_d D + pi rho_s colour lobe max(0, n.l)) + rig_ambient rho_d),   D: surface/reflectance/oren_nayar.h
// MODE: as ViewMode in viewer/render/view_mode.h. EYE: 1 where the viewer has a place. OUTPUT: 0 linear, 1 sRGB, 2 the
// monitor's own colours; linear values are clipped and encoded by the device where the target is sRGB.
// GREY: 1 where the exposure is the same for all colours, and mixes none. BARE: 1 for the background alone.

out vec4 o_colour;
STRAIGHT in vec3 v_place;

#if OUTPUT == 2
uniform sampler3D u_monitor;  // MonitorTable in viewer/render/display_profile.h

vec3 on_monitor(vec3 colour) {
    float side = float(textureSize(u_monitor, 0).x);
    return texture(u_monitor, (pow(colour, vec3(1.0 / 3.0)) * (side - 1.0) + 0.5) / side).rgb;
}
#endif

// sRGB: 12.92 v, or 1.055 v^(1/2.4) - 0.055, here as the polynomial of the root that is best in the sense of the largest
// error, 0.04 / 255: a power takes a software renderer far longer.
vec3 encode(vec3 v) {
    vec3 r = sqrt(v);
    vec3 high = -5.0002020 + r * (3.4160761 - 0.9467899 * r);
    vec3 curve = -0.0422301 + r * (1.5752202 + r * (-1.8990449 + r * (3.8968238 + r * high)));
    return min(mix(curve, 12.92 * v, lessThanEqual(v, vec3(0.0031308))), 1.0);
}

// Straight up to the shoulder s, then bent towards 1 with the same slope: 1 - (1 - s)^2 / (1 - 2 s + v).
vec3 toned(vec3 v) {
    if (v_exposure0.w <= 0.0) return v;
    float s = 1.0 - v_exposure0.w;
    vec3 over = clamp(v, s, 1e6) + (1.0 - 2.0 * s);
    // One division for three.
    float inverse = v_exposure0.w * v_exposure0.w / (over.x * over.y * over.z);
    // Up to the shoulder and what is beyond: the latter is 0 at it.
    return min(v, s) + (v_exposure0.w - inverse * over.yxx * over.zzy);
}

// Dark blue over green to yellow, even in lightness: five stops.
vec3 false_colour(float t) {
    t = clamp(t, 0.0, 1.0) * 4.0;
    vec3 a = vec3(0.058, 0.0003, 0.089), b = vec3(0.042, 0.084, 0.258), c = vec3(0.015, 0.279, 0.264);
    vec3 d = vec3(0.107, 0.578, 0.125), e = vec3(0.983, 0.799, 0.018);
    vec3 low = mix(mix(a, b, min(t, 1.0)), c, clamp(t - 1.0, 0.0, 1.0));
    return mix(mix(low, d, clamp(t - 2.0, 0.0, 1.0)), e, clamp(t - 3.0, 0.0, 1.0));
}

#if MODE == 10
// Mean curvature [1/mm] of the relief, half of the divergence of its normals: bumps are positive, hollows negative.
float curvature_at(vec2 at) {
    int level = v_size.z;
    float step_px = exp2(float(level));
    vec2 x = vec2(step_px, 0.0), y = vec2(0.0, step_px);
    float along_x = smooth_material(at + x, level).normal.x - smooth_material(at - x, level).normal.x;
    float along_y = smooth_material(at - y, level).normal.y - smooth_material(at + y, level).normal.y;
    return (along_x + along_y) / (4.0 * step_px * v_scene.x);
}

// Blue for hollows, grey where it is flat, orange for bumps.
vec3 diverging_colour(float t) {
    vec3 grey = vec3(0.35), end = t < 0.0 ? vec3(0.01, 0.12, 0.60) : vec3(0.85, 0.22, 0.005);
    return mix(grey, end, min(abs(t), 1.0));
}
#endif

vec3 lit(Material m, vec2 at) {
    vec3 point = point_mm(at, m.height);
#if EYE == 1
    vec3 v = normalize(v_eye.xyz - point);
#else
    vec3 v = v_eye.xyz;
#endif
    vec3 sum = v_scene.y * m.diffuse;
#if ANISOTROPIC == 1
    vec3 shape = shape_of(m.stretch);
#endif
    for (int i = 0; i < LIGHTS; ++i) {
        Incoming in_light = incoming(i, point);
        float n_l = dot(m.normal, in_light.direction);
        vec3 reflected = vec3(0.0);
        if (n_l > 0.0) {
            float lobe = pi_hazy_lobe(m.normal, in_light.direction, v, n_l, m.roughness WITH_SHAPE);
            vec3 diffuse = m.diffuse * matt_reflection(m.normal, in_light.direction, v, n_l);
            float gloss = m.specular * lobe;
#if MODE == 1  // specular enhancement: Malzbender et al. 2001: matt colour down, an even sharp gloss everywhere
            vec3 h = normalize(in_light.direction + v);
            diffuse *= 1.0 - v_look.x;
            gloss = v_look.x * pow(max(dot(h, m.normal), 0.0), v_look.y) / max(n_l, 0.05);
#elif MODE == 2  // diffuse gain: the fall-off from the brightest direction is steeper
            diffuse *= max(1.0 - v_look.x * (1.0 - n_l), 0.0) / max(n_l, 0.02);
#endif
#if SPECULAR_COLOUR == 1 && MODE != 1
            vec3 shine = gloss * m.specular_colour;
#else
            float shine = gloss;
#endif
            reflected = visibility(i, at, m.height, in_light.direction) * (diffuse + shine) * n_l;
        }
        sum += in_light.irradiance * (reflected + v_scene.z * m.diffuse);
    }
    return sum;
}

#if GREY == 1
vec3 exposed(vec3 v) { return v_exposure0.x * v; }
#else
vec3 exposed(vec3 v) { return mat3(v_exposure0.xyz, v_exposure1.xyz, v_exposure2.xyz) * v; }
#endif

vec3 looked_at(vec2 at) {
    Material m = material_at(at);
#if MODE == 3  // unsharp masking of the normals
    int coarse = min(v_size.z + int(v_look.y), v_size.w);
    m.normal = normalize(m.normal + v_look.x * (m.normal - smooth_material(at, coarse).normal));
#elif MODE == 4
    return false_colour((m.height - v_look.z) / max(v_look.w - v_look.z, 1e-9));
#elif MODE == 5
    return false_colour(log2(m.roughness / 0.02) / 6.0);
#elif MODE == 6
    return false_colour(sqrt(m.specular / 0.3));
#elif MODE == 7
    return false_colour(m.confidence);
#elif MODE == 8
    vec3 n = 0.5 * m.normal + 0.5;
    return pow(n, vec3(2.2));
#elif MODE == 9
    return exposed(m.diffuse);
#elif MODE == 10
    return diverging_colour(curvature_at(at) / v_look.w);
#endif
    return exposed(lit(m, at));
}

void main() {
    vec3 colour = v_background.xyz;
#if BARE == 0
    vec2 at = v_place.xy * (1.0 / v_place.z);
    vec2 last = vec2(v_size.xy) - 0.5;
    if (v_place.z > 0.0 && at.x >= -0.5 && at.y >= -0.5 && at.x < last.x && at.y < last.y) {
#if MODE >= 4
        colour = looked_at(at);
#else
        colour = toned(looked_at(at));
#endif
    }
#endif
#if OUTPUT == 1
    o_colour = vec4(encode(clamp(colour, 0.0, 1.0)), 1.0);
#elif OUTPUT == 2
    o_colour = vec4(on_monitor(clamp(colour, 0.0, 1.0)), 1.0);
#else
    o_colour = vec4(colour, 1.0);
#endif
}
