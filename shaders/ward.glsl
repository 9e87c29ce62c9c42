// ward.glsl: the Ward lobe in its three normalisations; mirrors surface/reflectance/ward.h and surface/reflectance/anisotropy.h, where the
// sources are.
// WARD_MODEL: WARD_ward1992, WARD_duer or WARD_bounded, which viewer/render/painting_shader.cpp defines. REFLECTANCE_MODEL: 1 where
// the painting's diffuse reflection is rough or its lobes are hazy (ReflectanceModel).

const float kGrazing = 1e-8;  // smallest cosine that is told from 0

#if ANISOTROPIC == 1
// cosh 2 s, and sinh(2 s) / s times the stretch (shape_of() of surface/reflectance/anisotropy.h).
vec3 shape_of(vec2 stretch) {
    float s = length(stretch);
    float wide = exp(2.0 * s), narrow = 1.0 / wide;
    return vec3(0.5 * (wide + narrow), s > 1e-4 ? 0.5 * (wide - narrow) / s * stretch : 2.0 * stretch);
}
#define SHAPE , vec3 shape
#define WITH_SHAPE , shape
#else
#define SHAPE
#define WITH_SHAPE
#endif

// pi times the lobe [1] for rho_s = 1. n, l, v: unit vectors; alpha: rms slope of the microfacets.
float pi_ward_lobe(vec3 n, vec3 l, vec3 v, float n_l, float alpha SHAPE) {
    float n_v = dot(n, v);
    vec3 h = l + v;
    float h_n = dot(h, n);
    float h_h = dot(h, h);
    if (n_l <= kGrazing || n_v <= kGrazing || h_n <= kGrazing) return 0.0;
    float alpha2 = alpha * alpha;
    float scale = 1.0 / (h_n * h_n * alpha2);
    // |h - (h.n) n|^2 rather than h.h - (h.n)^2: at narrow lobes the difference would be rounding alone.
#if ANISOTROPIC == 1
    vec2 t = h.xy - n.xy * ((h_n + h.z) / (1.0 + n.z));
    float off = shape.x * dot(t, t) - shape.y * (t.x * t.x - t.y * t.y) - 2.0 * shape.z * t.x * t.y;
    float gauss = exp(-off * scale);
#else
    vec3 across = h - h_n * n;
    float gauss = exp(-dot(across, across) * scale);
#endif
#if WARD_MODEL == WARD_ward1992
    return gauss / (4.0 * alpha2 * sqrt(n_l * n_v));
#elif WARD_MODEL == WARD_duer
    return gauss / (4.0 * alpha2 * n_l * n_v);
#else
    return gauss * h_h * alpha2 * scale * scale;
#endif
}

// The lobe and its second lobe: part of it is twice as wide (hazy_lobe() of surface/reflectance/ward.h).
float pi_hazy_lobe(vec3 n, vec3 l, vec3 v, float n_l, float alpha SHAPE) {
    float core = pi_ward_lobe(n, l, v, n_l, alpha WITH_SHAPE);
#if REFLECTANCE_MODEL == 1
    if (v_rest.x > 0.0) return mix(core, pi_ward_lobe(n, l, v, n_l, 2.0 * alpha WITH_SHAPE), v_rest.x);
#endif
    return core;
}

// pi f / rho_d: Lambert's law is 1; mirrors surface/reflectance/oren_nayar.h, where the sources are. n_l > 0.
float matt_reflection(vec3 n, vec3 l, vec3 v, float n_l) {
#if REFLECTANCE_MODEL == 1
    float n_v = dot(n, v);
    if (n_v <= 0.0) return 1.0;
    float s = dot(l, v) - n_l * n_v;
    float ratio = s <= 0.0 ? s : s / max(n_l, n_v);
    float rough = v_background.w;
    return (1.0 + rough * ratio) / (1.0 + (0.5 - 2.0 / (3.0 * 3.14159265358979)) * rough);
#else
    return 1.0;
#endif
}
