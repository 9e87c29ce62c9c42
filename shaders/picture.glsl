// picture.glsl: what is the same for all pixels of a picture: uniforms of the vertex shader, which go to the fragments as
// flat inputs. Mesa's software renderer (22.3) fetches a uniform anew for every pixel, each number with a check of
// its bounds: two thirds of its time. 15 vectors are what WebGL 2 has everywhere; further lights stay uniforms.

// What is passed on straight is no flat input, but linear across the screen: all corners have w = 1, and OpenGL ES knows no other way.
#ifdef GL_ES
#define STRAIGHT smooth
#else
#define STRAIGHT noperspective
#endif

PASSED vec3 v_scene;                                // mm per pixel, ambient, rig's ambient
PASSED vec4 v_exposure0, v_exposure1, v_exposure2;  // columns; shoulder, radius of the light (horizons: 1 / it), bend
PASSED vec4 v_eye;                                  // and the highest point
PASSED vec4 v_range;
PASSED vec4 v_background;                           // and the diffuse roughness
PASSED vec4 v_look;
PASSED vec4 v_light, v_light_gain;                    // the first light (NEAR == 0: and 1 / rows); and its azimuth
PASSED vec4 v_rest;  // second lobe; elevation of the first light; texels a pixel; 1 / columns of the painting
PASSED ivec4 v_size;                                // and level of detail, the coarsest level
PASSED ivec4 v_tiles;  // of this level: the first in the table, columns; AT_HOME: left, top, columns, rows and first << 16
