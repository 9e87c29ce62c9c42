// diffuse_gain.glsl: Malzbender et al. 2001: the fall-off from the brightest direction is steeper. v_look: strength.
#define CHANGES_REFLECTION

void change_reflection(inout vec3 diffuse, inout float gloss, Material m, vec3 light, vec3 v, float n_l) {
    diffuse *= max(1.0 - v_look.x * (1.0 - n_l), 0.0) / max(n_l, 0.02);
}
