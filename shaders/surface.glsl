// surface.glsl: the maps of a surface, packed into one texel of 128 bits as viewer/render/texels.h describes, in square tiles:
// those that are seen, of any level of detail, are the layers of an array texture; a table says which. AT_HOME: 1 where
// those of the picture's own level lie where column and row say (viewer/render/tile_cache.h), which spares each pixel the table.
// SPECULAR_COLOUR: 1 where lobes have colours, for which gloss, confidence and height have fewer bits; ANISOTROPIC: 1 where they
// are anisotropic as well, for which everything has.

uniform highp usampler2DArray u_texels;

struct Material {
    vec3 normal;       // [unit vector]
    vec3 diffuse;      // [1] rho_d
    float specular;    // [1] rho_s
    float roughness;   // [1] alpha
    float height;      // [mm]
    float confidence;  // [1]
#if SPECULAR_COLOUR == 1
    vec3 specular_colour;  // [1]
#endif
#if ANISOTROPIC == 1
    vec2 stretch;  // [1] surface/reflectance/anisotropy.h
#endif
};

ivec2 size_at(int level) { return (v_size.xy + ((1 << level) - 1)) >> level; }

uniform highp usampler2D u_pages;  // 1024 wide; of each tile: layer (11 bits) and level of the finest that covers it
uniform int u_first_page[32];      // of each level: where its tiles begin, row by row

const int kPageBits = 8;
// A tile lies in its layer as strips of 16 columns, one below the other: the 16 x 16 pixels that a software renderer draws
// next to each other are then a page of memory, where rows of the tile's own width would be on 16 of them.
const int kStripBits = 4, kStrips = 1 << (kPageBits - kStripBits);
const vec2 kStripTexel = 1.0 / vec2(1 << kStripBits, kStrips << kPageBits);

// The texel of a layer, at a place of the level of detail that it has a tile of: the texture repeats itself across, so that the
// tile's own place need not be known. Not texelFetch, for which Mesa's software renderer (22.3) looks the level up for each pixel.
uvec4 texel_of(ivec2 at, int layer) {
    int strip = (at.x >> kStripBits) & (kStrips - 1), row = at.y & ((1 << kPageBits) - 1);
    return textureLod(u_texels, vec3((vec2(at.x, strip << kPageBits | row) + 0.5) * kStripTexel, float(layer)), 0.0);
}

uvec4 texel_in(ivec2 at, int level, int first_page, int columns) {
    ivec2 tile = at >> kPageBits;
    int page = first_page + tile.y * columns + tile.x;
    uint found = texelFetch(u_pages, ivec2(page & 1023, page >> 10), 0).r;
    return texel_of(at >> (int(found >> 11) - level), int(found & 2047u));
}

int columns_at(int level) { return (size_at(level).x + (1 << kPageBits) - 1) >> kPageBits; }

uvec4 texel_at(ivec2 at, int level) { return texel_in(at, level, u_first_page[level], columns_at(level)); }

// Of the picture's own level.
uvec4 texel_here(ivec2 at) {
#if AT_HOME == 1
    uvec2 grid = uvec2(v_tiles.z, v_tiles.w & 0xffff), tile = uvec2((at >> kPageBits) + v_tiles.xy);
    tile = min(tile, tile - grid);  // less the grid where it is not below it: else that is a very large number
    return texel_of(at, int(uint(v_tiles.w >> 16) + tile.y * grid.x + tile.x));
#else
    return texel_in(at, v_size.z, v_tiles.x, v_tiles.y);
#endif
}

vec2 halves(uint bits) { return vec2(float(bits & 0xffffu), float(bits >> 16)) * (1.0 / 65535.0); }

#if ANISOTROPIC == 1
float height_in(uvec4 texel) { return v_range.z + v_range.w * float(texel.w >> 16) * (1.0 / 65535.0); }
#elif SPECULAR_COLOUR == 1
float height_in(uvec4 texel) { return v_range.z + v_range.w * float(texel.w >> 15) * (1.0 / 131071.0); }
#else
float height_in(uvec4 texel) { return v_range.z + v_range.w * float(texel.w >> 8) * (1.0 / 16777215.0); }
#endif

// Two channels from the largest on that are beside it.
vec3 colour_of(uint largest, uint after, uint before) {
    vec3 colour = vec3(1.0, vec2(float(after), float(before)) * (1.0 / 127.0));
    return largest == 0u ? colour : largest == 1u ? colour.zxy : colour.yzx;
}

Material unpack(uvec4 texel) {
    Material m;
    // Normal: octahedron, upper half.
#if ANISOTROPIC == 1
    vec2 uv = vec2(float(texel.x & 0x1fffu), float((texel.x >> 13) & 0xfffu)) * vec2(2.0 / 8191.0, 2.0 / 4095.0) - 1.0;
    vec3 root = vec3(float(texel.y & 0x3ffu), float((texel.y >> 10) & 0x3ffu), float((texel.y >> 20) & 0x1ffu)) *
                vec3(1.0 / 1023.0, 1.0 / 1023.0, 1.0 / 511.0);
#else
    vec2 uv = 2.0 * halves(texel.x) - 1.0;
    vec3 root = vec3(float(texel.y & 0x7ffu), float((texel.y >> 11) & 0x7ffu), float(texel.y >> 22)) *
                vec3(1.0 / 2047.0, 1.0 / 2047.0, 1.0 / 1023.0);
#endif
    vec2 xy = 0.5 * vec2(uv.x + uv.y, uv.x - uv.y);
    m.normal = normalize(vec3(xy, 1.0 - abs(xy.x) - abs(xy.y)));
    m.diffuse = v_range.x * root * root;
#if ANISOTROPIC == 1
    vec2 gloss = vec2(float(texel.z & 0x7ffu), float((texel.z >> 11) & 0xfffu)) * vec2(1.0 / 2047.0, 1.0 / 4095.0);
    m.confidence = float(texel.y >> 29) * (1.0 / 7.0);
    m.specular_colour = colour_of(texel.z >> 30, (texel.z >> 23) & 0x7fu, texel.x >> 25);
    m.stretch = vec2(float(texel.w & 0xffu), float((texel.w >> 8) & 0xffu)) * (1.0 / 127.0) - 1.0;
#elif SPECULAR_COLOUR == 1
    vec2 gloss = vec2(float(texel.z & 0xfffu), float((texel.z >> 12) & 0x1fffu)) * vec2(1.0 / 4095.0, 1.0 / 8191.0);
    m.confidence = float(texel.w & 0x3fu) * (1.0 / 63.0);
    m.specular_colour = colour_of((texel.w >> 6) & 3u, texel.z >> 25, (texel.w >> 8) & 0x7fu);
#else
    vec2 gloss = halves(texel.z);
    m.confidence = float(texel.w & 0xffu) * (1.0 / 255.0);
#endif
    m.specular = v_range.y * gloss.x * gloss.x;
    m.roughness = exp2(20.0 * gloss.y - 14.0);
    m.height = height_in(texel);
    return m;
}

// The texel of the picture's level that is nearest to `at` [pixels of the painting, whole numbers are centres].
Material nearest_material(vec2 at) {
    // Of the painting, where it is at least -0.5; rounding must not lead over its far border.
    return unpack(texel_here(ivec2(min(at + 0.5, vec2(v_size.xy) - 0.5) * v_rest.z)));
}

// Between the four nearest of a level: maps are mixed, alpha as its square (a variance).
// `here`: of the picture's own.
Material smooth_in(vec2 at, int level, bool here) {
    vec2 c = (at + 0.5) * exp2(-float(level)) - 0.5;
    ivec2 i = ivec2(floor(c)), last = size_at(level) - 1;
    vec2 f = c - vec2(i);
    ivec2 low = clamp(i, ivec2(0), last), high = clamp(i + 1, ivec2(0), last);
    ivec2 right = ivec2(high.x, low.y), below = ivec2(low.x, high.y);
    Material a = unpack(here ? texel_here(low) : texel_at(low, level));
    Material b = unpack(here ? texel_here(right) : texel_at(right, level));
    Material c2 = unpack(here ? texel_here(below) : texel_at(below, level));
    Material d = unpack(here ? texel_here(high) : texel_at(high, level));
    vec4 w = vec4((1.0 - f.x) * (1.0 - f.y), f.x * (1.0 - f.y), (1.0 - f.x) * f.y, f.x * f.y);
    Material m;
    m.normal = normalize(w.x * a.normal + w.y * b.normal + w.z * c2.normal + w.w * d.normal);
    m.diffuse = w.x * a.diffuse + w.y * b.diffuse + w.z * c2.diffuse + w.w * d.diffuse;
    m.specular = dot(w, vec4(a.specular, b.specular, c2.specular, d.specular));
    vec4 alpha = vec4(a.roughness, b.roughness, c2.roughness, d.roughness);
    m.roughness = sqrt(dot(w, alpha * alpha));
    m.height = dot(w, vec4(a.height, b.height, c2.height, d.height));
    m.confidence = dot(w, vec4(a.confidence, b.confidence, c2.confidence, d.confidence));
#if SPECULAR_COLOUR == 1
    m.specular_colour = w.x * a.specular_colour + w.y * b.specular_colour + w.z * c2.specular_colour + w.w * d.specular_colour;
#endif
#if ANISOTROPIC == 1
    m.stretch = w.x * a.stretch + w.y * b.stretch + w.z * c2.stretch + w.w * d.stretch;
#endif
    return m;
}

Material smooth_material(vec2 at, int level) { return smooth_in(at, level, false); }

#if FILTER == 1
Material material_at(vec2 at) { return smooth_in(at, v_size.z, true); }
#else
Material material_at(vec2 at) { return nearest_material(at); }
#endif
