// surface.glsl: the maps of a surface, packed into one texel of 128 bits as viewer/texels.h describes, in square tiles:
// the layers of an array texture.
// PAGED: 0 every layer has its own levels of detail; 1 layers hold the tiles, of any level, that a page has fetched.

uniform highp usampler2DArray u_texels;

struct Material {
    vec3 normal;       // [unit vector]
    vec3 diffuse;      // [1] rho_d
    float specular;    // [1] rho_s
    float roughness;   // [1] alpha
    float height;      // [mm]
    float confidence;  // [1]
};

ivec2 size_at(int level) { return (v_size.xy + ((1 << level) - 1)) >> level; }

#if PAGED == 1
uniform highp usampler2D u_pages;  // 1024 wide; of each tile: layer (11 bits) and level of the finest that covers it
uniform int u_first_page[32];      // of each level: where its tiles begin, row by row

const int kPageBits = 8;

uvec4 texel_at(ivec2 at, int level) {
    ivec2 tile = at >> kPageBits;
    int columns = (size_at(level).x + (1 << kPageBits) - 1) >> kPageBits;
    int page = u_first_page[level] + tile.y * columns + tile.x;
    uint found = texelFetch(u_pages, ivec2(page & 1023, page >> 10), 0).r;
    ivec2 place = at >> (int(found >> 11) - level);
    return texelFetch(u_texels, ivec3(place & ((1 << kPageBits) - 1), int(found & 2047u)), 0);
}
#else
uvec4 texel_at(ivec2 at, int level) {
    int bits = v_tiles.x - level;
    ivec2 tile = at >> bits;
    ivec2 inside = at - (tile << bits);
    return texelFetch(u_texels, ivec3(inside, tile.y * v_tiles.y + tile.x), level);
}
#endif

vec2 halves(uint bits) { return vec2(float(bits & 0xffffu), float(bits >> 16)) * (1.0 / 65535.0); }

float height_in(uvec4 texel) { return v_range.z + v_range.w * float(texel.w >> 8) * (1.0 / 16777215.0); }

Material unpack(uvec4 texel) {
    Material m;
    // Normal: octahedron, upper half.
    vec2 uv = 2.0 * halves(texel.x) - 1.0;
    vec2 xy = 0.5 * vec2(uv.x + uv.y, uv.x - uv.y);
    m.normal = normalize(vec3(xy, 1.0 - abs(xy.x) - abs(xy.y)));
    vec3 root = vec3(float(texel.y & 0x7ffu), float((texel.y >> 11) & 0x7ffu), float(texel.y >> 22)) *
                vec3(1.0 / 2047.0, 1.0 / 2047.0, 1.0 / 1023.0);
    m.diffuse = v_range.x * root * root;
    vec2 gloss = halves(texel.z);
    m.specular = v_range.y * gloss.x * gloss.x;
    m.roughness = exp2(20.0 * gloss.y - 14.0);
    m.height = height_in(texel);
    m.confidence = float(texel.w & 0xffu) * (1.0 / 255.0);
    return m;
}

// The pixel nearest to `at` [pixels of the painting, whole numbers are centres].
Material nearest_material(vec2 at, int level) {
    ivec2 i = ivec2(floor((at + 0.5) * exp2(-float(level))));
    return unpack(texel_at(clamp(i, ivec2(0), size_at(level) - 1), level));
}

// Between the four nearest: maps are mixed, alpha as its square (a variance).
Material smooth_material(vec2 at, int level) {
    vec2 c = (at + 0.5) * exp2(-float(level)) - 0.5;
    ivec2 i = ivec2(floor(c)), last = size_at(level) - 1;
    vec2 f = c - vec2(i);
    ivec2 low = clamp(i, ivec2(0), last), high = clamp(i + 1, ivec2(0), last);
    Material a = unpack(texel_at(low, level)), b = unpack(texel_at(ivec2(high.x, low.y), level));
    Material c2 = unpack(texel_at(ivec2(low.x, high.y), level)), d = unpack(texel_at(high, level));
    vec4 w = vec4((1.0 - f.x) * (1.0 - f.y), f.x * (1.0 - f.y), (1.0 - f.x) * f.y, f.x * f.y);
    Material m;
    m.normal = normalize(w.x * a.normal + w.y * b.normal + w.z * c2.normal + w.w * d.normal);
    m.diffuse = w.x * a.diffuse + w.y * b.diffuse + w.z * c2.diffuse + w.w * d.diffuse;
    m.specular = dot(w, vec4(a.specular, b.specular, c2.specular, d.specular));
    vec4 alpha = vec4(a.roughness, b.roughness, c2.roughness, d.roughness);
    m.roughness = sqrt(dot(w, alpha * alpha));
    m.height = dot(w, vec4(a.height, b.height, c2.height, d.height));
    m.confidence = dot(w, vec4(a.confidence, b.confidence, c2.confidence, d.confidence));
    return m;
}

#if FILTER == 1
Material material_at(vec2 at) { return smooth_material(at, v_size.z); }
#else
Material material_at(vec2 at) { return nearest_material(at, v_size.z); }
#endif
