// painting.frag.glsl: what a painting looks like under its lights, or one of its maps. Values as relight() in
// surface/render/relight.h:
//   value = ambient rho_d + sum over lights of irradiance *
//           (visibility (rho_d D + pi rho_s colour lobe max(0, n.l)) + rig_ambient rho_d),   D: surface/reflectance/oren_nayar.h
// EYE: 1 where the viewer has a place. BARE: 1 for the background alone. Before this comes the chunk of the view mode, from
// shaders/modes/ (viewer/render/view_mode.h), which defines one of these and its function, or none:
//   SHOWS_MAP           vec3 map_colour(Material m, vec2 at): what is shown instead of what is lit; without the tone curve
//   CHANGES_MATERIAL    void change_material(inout Material m, vec2 at): before it is lit
//   CHANGES_REFLECTION  void change_reflection(inout vec3 diffuse, inout float gloss, Material m, vec3 light, vec3 v, float n_l):
//                       of one light; with GREY_GLOSS the gloss does not take the lobe's colour

out vec4 o_colour;
STRAIGHT in vec3 v_place;

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
#ifdef CHANGES_REFLECTION
            change_reflection(diffuse, gloss, m, in_light.direction, v, n_l);
#endif
#if SPECULAR_COLOUR == 1 && !defined(GREY_GLOSS)
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

vec3 looked_at(vec2 at) {
    Material m = material_at(at);
#ifdef SHOWS_MAP
    return map_colour(m, at);
#else
#ifdef CHANGES_MATERIAL
    change_material(m, at);
#endif
    return exposed(lit(m, at));
#endif
}

void main() {
    vec3 colour = v_background.xyz;
#if BARE == 0
    vec2 at = v_place.xy * (1.0 / v_place.z);
    vec2 last = vec2(v_size.xy) - 0.5;
    if (v_place.z > 0.0 && at.x >= -0.5 && at.y >= -0.5 && at.x < last.x && at.y < last.y) {
#ifdef SHOWS_MAP
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
