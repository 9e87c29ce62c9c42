// unsharp_normals.glsl: unsharp masking of the normals. v_look: strength, how many levels of detail coarser the mask is.
#define CHANGES_MATERIAL

void change_material(inout Material m, vec2 at) {
    int coarse = min(v_size.z + int(v_look.y), v_size.w);
    m.normal = normalize(m.normal + v_look.x * (m.normal - smooth_material(at, coarse).normal));
}
