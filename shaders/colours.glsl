// colours.glsl: from linear light or a number to what is shown: exposure, tone curve, false colours, encoding.
// OUTPUT: 0 linear, 1 sRGB, 2 the monitor's own colours; linear values are clipped and encoded by the device where the
// target is sRGB. GREY: 1 where the exposure is the same for all colours, and mixes none.

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

// Blue for hollows, grey where it is flat, orange for bumps.
vec3 diverging_colour(float t) {
    vec3 grey = vec3(0.35), end = t < 0.0 ? vec3(0.01, 0.12, 0.60) : vec3(0.85, 0.22, 0.005);
    return mix(grey, end, min(abs(t), 1.0));
}

#if GREY == 1
vec3 exposed(vec3 v) { return v_exposure0.x * v; }
#else
vec3 exposed(vec3 v) { return mat3(v_exposure0.xyz, v_exposure1.xyz, v_exposure2.xyz) * v; }
#endif

