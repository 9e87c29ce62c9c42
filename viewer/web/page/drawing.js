// drawing.js: the painting drawn by WebGL 2 with the window's shaders, as viewer/render/renderer.cpp does.

import {clamp, degree} from './placement.js';
import {Tiles} from './tiles.js';

export const usualSoftness = 1.5;  // [degrees], as in the window

const header = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler3D;
precision highp usampler2D;
precision highp usampler2DArray;
`;

// Linear RGB of a light from its sRGB colour, "#ffcc88": as a filter before a white light, its strongest channel stays as it is.
export function gainOf(colour) {
  const linear = [1, 3, 5].map(i => parseInt(colour.slice(i, i + 2), 16) / 255).map(v => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
  const most = Math.max(...linear);
  return most > 0 ? linear.map(v => v / most) : [1, 1, 1];
}

// Drawing.draw()'s scene: what a page's state says, under this light [unit vector, surface's frame]. softness: its angular radius
// [degrees].
export function sceneOf(picture, {look, shadows, ambient, exposure, shoulder, colour = '#ffffff', softness = usualSoftness}, light) {
  const {name} = picture.looks[look];
  return {light, gain: gainOf(colour), softness, look, shadows, ambient, exposure, shoulder, strength: name === 'Specular enhancement' ? 0.7 : 2.1,
    sharpness: name === 'Unsharp normals' ? 3 : 40};
}

export class Drawing {
  // picture: what viewer/web/web_data.h says of it, and `levels`. `layers` and `source`: as Tiles has them.
  constructor(canvas, picture, layers, source) {
    this.gl = canvas.getContext('webgl2', {alpha: false, antialias: false, depth: false, stencil: false, powerPreference: 'high-performance'});
    if (!this.gl) throw new Error('WebGL 2 is missing');
    Object.assign(this, {picture, source, programs: new Map(), horizon: null});
    this.tiles = new Tiles(this.gl, picture, layers, source);
    this.gl.bindVertexArray(this.gl.createVertexArray());
  }
  // The map of horizons (viewer/render/horizon.h), which may come when the picture is there, or anew.
  setHorizon(width, height, azimuths, values) {
    const {gl} = this;
    if (this.horizon) gl.deleteTexture(this.horizon);
    this.horizon = gl.createTexture();
    gl.activeTexture(gl.TEXTURE0 + 1);
    gl.bindTexture(gl.TEXTURE_3D, this.horizon);
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_3D, name, gl.LINEAR);
    for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_3D, name, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_3D, gl.TEXTURE_WRAP_R, gl.REPEAT);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texImage3D(gl.TEXTURE_3D, 0, gl.R8, width, height, azimuths, 0, gl.RED, gl.UNSIGNED_BYTE, values);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 4);
    this.source.changed();
  }
  shader(kind, text) {
    const {gl} = this, shader = gl.createShader(kind);
    gl.shaderSource(shader, header + text);
    gl.compileShader(shader);
    return shader;
  }
  program(definitions) {
    let found = this.programs.get(definitions);
    if (found) return found;
    const {gl} = this, program = gl.createProgram();
    const parts = [this.shader(gl.VERTEX_SHADER, definitions + this.picture.vertex_shader), this.shader(gl.FRAGMENT_SHADER, definitions + this.picture.fragment_shader)];
    for (const shader of parts) gl.attachShader(program, shader);
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS))
      throw new Error(`the shader does not compile: ${parts.map(s => gl.getShaderInfoLog(s)).join(' ')} ${gl.getProgramInfoLog(program)}`);
    const places = new Map();
    found = {program, at: name => {
      if (!places.has(name)) places.set(name, gl.getUniformLocation(program, name));
      return places.get(name);
    }};
    this.programs.set(definitions, found);
    return found;
  }

  // Asks for the tiles that these shots need, and draws them one over the other with those that are there. scene: what sceneOf()
  // returns. shots: [{camera, rectangle, only, part, smooth}]: a Placement or what else says `seen`, `level`, `shot` and `eye` as it
  // does; the rectangle of the canvas that its screen fills, {left, bottom, width, height}, and the part of this that is drawn, where it
  // is not all; pixels for one of its screen; whether it is mixed between texels.
  show(scene, shots) {
    const {tiles} = this, views = shots.map(({camera, part}) => {
      const seen = camera.seen();
      return {level: tiles.affordable(camera.level(part), seen), seen};
    });
    // What is around a pixel, without its details.
    const around = this.picture.looks[scene.look].name === 'Unsharp normals' ? [{...views[0], level: Math.min(views[0].level + 3, this.picture.levels - 1)}] : [];
    tiles.want([...views, ...around]);
    shots.forEach(({camera, rectangle, only, smooth}, i) => {
      const {left, bottom, width, height} = rectangle;
      this.draw(scene, {matrix: camera.shot(width, height, left, bottom), eye: camera.eye, level: views[i].level, smooth}, rectangle, only);
    });
  }
  draw(scene, shot, rectangle, only = rectangle) {
    const {gl, tiles, picture: data} = this;
    gl.viewport(rectangle.left, rectangle.bottom, rectangle.width, rectangle.height);
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(only.left, only.bottom, Math.max(only.width, 0), Math.max(only.height, 0));
    if (!tiles.ready) {
      gl.clearColor(0.15, 0.15, 0.15, 1);
      gl.clear(gl.COLOR_BUFFER_BIT);
      return;
    }
    const [x, y, z] = scene.light, shadows = scene.shadows && this.horizon ? 1 : 0, [roughness, second_lobe_weight] = data.reflectance_model;
    const definitions = Object.entries({WARD_MODEL: 'WARD_bounded', REFLECTANCE_MODEL: roughness || second_lobe_weight ? 1 : 0, SPECULAR_COLOUR: data.specular_colour ? 1 : 0, ANISOTROPIC: data.anisotropic_specular ? 1 : 0, FILTER: shot.smooth ? 1 : 0, AT_HOME: 0,
      LIGHTS: 1, NEAR: 0, BENDS: 0, BEAMS: 0, SHADOWS: shadows, EYE: 1, MODE: scene.look, OUTPUT: 1, GREY: 1, BARE: 0}).map(([name, value]) => `#define ${name} ${value}\n`).join('');
    const {program, at} = this.program(definitions);
    gl.useProgram(program);
    tiles.bind(0, 2);
    gl.activeTexture(gl.TEXTURE0 + 1);
    gl.bindTexture(gl.TEXTURE_3D, this.horizon);
    gl.uniform1i(at('u_texels'), 0);
    gl.uniform1i(at('u_horizon'), 1);
    gl.uniform1i(at('u_pages'), 2);
    gl.uniform1iv(at('u_first_page'), tiles.levels.map(l => l.first));
    gl.uniform2i(at('u_size'), data.width, data.height);
    gl.uniform1i(at('u_last_level'), data.levels - 1);
    gl.uniform1i(at('u_level'), shot.level);
    gl.uniform4fv(at('u_range'), data.range);
    gl.uniform1f(at('u_mm_per_pixel'), data.mm_per_pixel);
    gl.uniform4fv(at('u_light'), [x, y, z, 0]);
    gl.uniform3fv(at('u_gain'), scene.gain);
    gl.uniform2fv(at('u_place'), [Math.atan2(y, x) / (2 * Math.PI), Math.asin(clamp(z, -1, 1))]);
    gl.uniform2fv(at('u_reflectance_model'), data.reflectance_model);
    gl.uniform1f(at('u_light_radius'), scene.softness * degree);
    gl.uniform4f(at('u_viewport'), rectangle.left, rectangle.bottom, rectangle.width, rectangle.height);
    gl.uniformMatrix3fv(at('u_to_painting'), false, shot.matrix);
    gl.uniform4fv(at('u_eye'), shot.eye);
    gl.uniform1f(at('u_ambient'), scene.ambient);
    gl.uniform1f(at('u_rig_ambient'), 0);
    const exposure = 2 ** scene.exposure;
    gl.uniformMatrix3fv(at('u_exposure'), false, [exposure, 0, 0, 0, exposure, 0, 0, 0, exposure]);
    gl.uniform1f(at('u_shoulder'), scene.shoulder);
    gl.uniform3fv(at('u_background'), [0.02, 0.02, 0.02]);
    gl.uniform4fv(at('u_look'), [scene.strength, scene.sharpness, ...data.looks[scene.look].ends]);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }
}
