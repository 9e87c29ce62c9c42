// curvature.glsl: how far the relief bends: bumps orange, hollows blue.
#define SHOWS_MAP

// Mean curvature [1/mm] of the relief, half of the divergence of its normals: bumps are positive, hollows negative.
float curvature_at(vec2 at) {
    int level = v_size.z;
    float step_px = exp2(float(level));
    vec2 x = vec2(step_px, 0.0), y = vec2(0.0, step_px);
    float along_x = smooth_material(at + x, level).normal.x - smooth_material(at - x, level).normal.x;
    float along_y = smooth_material(at - y, level).normal.y - smooth_material(at + y, level).normal.y;
    return (along_x + along_y) / (4.0 * step_px * v_scene.x);
}

vec3 map_colour(Material m, vec2 at) { return diverging_colour(scaled(curvature_at(at))); }
