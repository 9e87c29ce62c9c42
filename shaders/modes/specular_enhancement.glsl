// specular_enhancement.glsl: Malzbender et al. 2001: diffuse colour down, an even sharp gloss everywhere.
// v_look: strength, exponent of the gloss.
#define CHANGES_REFLECTION
#define GREY_GLOSS

void change_reflection(inout vec3 diffuse, inout float gloss, Material m, vec3 light, vec3 v, float n_l) {
    vec3 h = normalize(light + v);
    diffuse *= 1.0 - v_look.x;
    gloss = v_look.x * pow(max(dot(h, m.normal), 0.0), v_look.y) / max(n_l, 0.05);
}
