// drawing.js: the painting drawn by WebGL 2 with the window's shaders, as viewer/render/renderer.cpp does.

const header = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler3D;
precision highp usampler2D;
precision highp usampler2DArray;
`;

class Drawing {
  constructor(canvas, layers, changed, failed) {
    this.gl = canvas.getContext('webgl2', {alpha: false, antialias: false, depth: false, stencil: false, powerPreference: 'high-performance'});
    if (!this.gl || typeof DecompressionStream === 'undefined') throw new Error('WebGL 2 is missing');
    this.programs = new Map();
    this.changed = changed;
    this.tiles = new Tiles(this.gl, layers, changed, failed);
    this.gl.bindVertexArray(this.gl.createVertexArray());
    this.loadHorizon().catch(() => failed('horizon'));
  }
  // The map of horizons comes when the picture is there.
  async loadHorizon() {
    const [width, height, azimuths] = data.horizon;
    this.horizon = null;
    if (width === 0) return;
    const bytes = await part('horizon');
    for (let i = 1; i < bytes.length; ++i) bytes[i] += bytes[i - 1];
    const {gl} = this;
    this.horizon = gl.createTexture();
    gl.activeTexture(gl.TEXTURE0 + 1);
    gl.bindTexture(gl.TEXTURE_3D, this.horizon);
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_3D, name, gl.LINEAR);
    for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_3D, name, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_3D, gl.TEXTURE_WRAP_R, gl.REPEAT);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texImage3D(gl.TEXTURE_3D, 0, gl.R8, width, height, azimuths, 0, gl.RED, gl.UNSIGNED_BYTE, bytes);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 4);
    this.changed();
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
    const parts = [this.shader(gl.VERTEX_SHADER, definitions + data.vertex_shader), this.shader(gl.FRAGMENT_SHADER, definitions + data.fragment_shader)];
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

  // scene: {light [unit vector, surface's frame], look, shadows, ambient, exposure, shoulder, strength, sharpness}.
  // shot: {matrix, eye, level, smooth}; rectangle of the canvas: {left, bottom, width, height}.
  draw(scene, shot, rectangle) {
    const {gl, tiles} = this;
    gl.viewport(rectangle.left, rectangle.bottom, rectangle.width, rectangle.height);
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
    gl.uniform3fv(at('u_gain'), [1, 1, 1]);
    gl.uniform2fv(at('u_place'), [Math.atan2(y, x) / (2 * Math.PI), Math.asin(clamp(z, -1, 1))]);
    gl.uniform2fv(at('u_reflectance_model'), data.reflectance_model);
    gl.uniform1f(at('u_light_radius'), 1.5 * degree);
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
