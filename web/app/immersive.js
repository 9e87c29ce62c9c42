// immersive.js: the painting in the room, in its true size, as a headset or a tablet that knows its place shows it: WebXR's
// immersive-ar, where a browser has it (thesis 5.3.3). It hangs before the viewer at first, then where he points: on the wall or table
// there, where the device knows them. The room's brightest light falls on it, where the device estimates that.

import {directionOf} from './shared/placement.js';
import {RoomCamera, hung, hungBefore, xyz} from './room_camera.js';

const armsLength = 1.2;  // [m] to where a painting hangs at first

export const inRoomIsThere = async () => Boolean(await navigator.xr?.isSessionSupported?.('immersive-ar').catch(() => false));

// Only where the painting is, so that the room is seen around it.
class Mask {
  constructor(gl) {
    this.gl = gl;
    this.program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, `uniform mat3 u_to_clip; uniform vec2 u_size;
      void main() { vec3 at = u_to_clip * vec3(vec2(gl_VertexID & 1, gl_VertexID >> 1) * u_size - 0.5, 1.0); gl_Position = vec4(at.xy, 0.0, at.z); }`],
    [gl.FRAGMENT_SHADER, 'void main() {}']]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, `#version 300 es\nprecision highp float;\n${text}`);
      gl.compileShader(shader);
      gl.attachShader(this.program, shader);
    }
    gl.linkProgram(this.program);
  }
  // What is drawn from here on is drawn there alone.
  draw({toClip, picture}, {left, bottom, width, height}) {
    const {gl, program} = this;
    gl.useProgram(program);
    gl.viewport(left, bottom, width, height);
    gl.disable(gl.SCISSOR_TEST);
    gl.uniformMatrix3fv(gl.getUniformLocation(program, 'u_to_clip'), false, toClip);
    gl.uniform2f(gl.getUniformLocation(program, 'u_size'), picture.width, picture.height);
    gl.enable(gl.STENCIL_TEST);
    gl.colorMask(false, false, false, false);
    gl.stencilFunc(gl.ALWAYS, 1, 255);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.REPLACE);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    gl.colorMask(true, true, true, true);
    gl.stencilFunc(gl.EQUAL, 1, 255);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.KEEP);
  }
}

export class Immersive {
  // overlay: an element to be shown over the room; ended(): the viewer is back.
  constructor(overlay, ended) { Object.assign(this, {overlay, ended, session: null}); }
  get runs() { return this.session !== null; }
  // To be called from a click. view: View. Words where it cannot be; nothing where it runs.
  async start(view) {
    try {
      const session = await navigator.xr.requestSession('immersive-ar', {optionalFeatures: ['hit-test', 'light-estimation', 'dom-overlay'], domOverlay: {root: this.overlay}});
      Object.assign(this, {session, view, place: null, mask: null, hits: null, probe: null});
      session.addEventListener('end', () => this.leave());
      session.addEventListener('select', ({frame, inputSource}) => this.point(frame, inputSource));
      await this.prepare();
      session.requestAnimationFrame((_, frame) => this.frame(frame));
      return '';
    } catch (error) {
      await this.session?.end().catch(() => {});
      return error.name === 'NotAllowedError' ? 'The browser was not allowed to show the room: allow it in its settings.' : `The room cannot be shown: ${error.message}`;
    }
  }
  stop() { return this.session?.end(); }

  async prepare() {
    const {session, view: {drawing: {gl}}} = this;
    await gl.makeXRCompatible();
    this.layer = new XRWebGLLayer(session, gl, {alpha: true, depth: false, stencil: true, antialias: false});
    await session.updateRenderState({baseLayer: this.layer});
    this.space = await session.requestReferenceSpace('local');
    this.mask = new Mask(gl);
    // What the device does not have is done without.
    this.hits = await session.requestHitTestSourceForTransientInput?.({profile: 'generic-touchscreen'}).catch(() => null);
    this.probe = await session.requestLightProbe?.().catch(() => null);
    this.overlay.hidden = false;
  }
  leave() {
    this.session = null;
    this.view.drawing.gl.deleteProgram(this.mask?.program ?? null);
    this.overlay.hidden = true;
    this.ended();
  }
  frame(frame) {
    const {session, view, layer, space} = this, pose = this.session && frame.getViewerPose(space);
    session?.requestAnimationFrame((_, next) => this.frame(next));
    if (!pose || view.closed) return;
    const {matrix: m} = pose.transform;
    this.place ??= hungBefore(xyz(pose.transform.position), [-m[8], -m[9], -m[10]], armsLength);
    this.viewer = xyz(pose.transform.position);
    this.touched = this.hits ? frame.getHitTestResultsForTransientInput(this.hits) : [];
    const {gl, tiles} = view.drawing, light = this.light(frame);
    gl.bindFramebuffer(gl.FRAMEBUFFER, layer.framebuffer);
    gl.disable(gl.SCISSOR_TEST);
    gl.clearColor(0, 0, 0, 0);
    gl.clearStencil(0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    for (const eye of tiles.ready ? pose.views : []) this.draw(eye, layer.getViewport(eye), light);
    gl.disable(gl.STENCIL_TEST);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }
  draw(eye, {x, y, width, height}, light) {
    const {view} = this, rectangle = {left: x, bottom: y, width, height}, camera = new RoomCamera(view.picture, this.place, eye, rectangle);
    this.mask.draw(camera, rectangle);
    view.drawing.show(view.sceneUnder(light ? camera.inSurface(light) : directionOf(view.state.light)), [{camera, rectangle, part: 1, smooth: true}]);
  }
  // Direction in the room to its brightest light, where the device estimates it; of one behind the painting that comes from before it,
  // as with the camera (camera.js).
  light(frame) {
    const estimate = this.probe && frame.getLightEstimate(this.probe), at = estimate && frame.getPose(this.probe.probeSpace, this.space);
    if (!at || !(estimate.primaryLightIntensity.x + estimate.primaryLightIntensity.y + estimate.primaryLightIntensity.z > 0)) return null;
    const {matrix: m} = at.transform, [x, y, z] = xyz(estimate.primaryLightDirection), direction = [0, 1, 2].map(r => m[r] * x + m[4 + r] * y + m[8 + r] * z);
    const front = this.place.axes.slice(6), out = direction.reduce((sum, v, i) => sum + v * front[i], 0);
    return out < 0 ? direction.map((v, i) => v - 2 * out * front[i]) : direction;
  }
  // Where the viewer points: on what the device sees there, or as far away as the painting was at first.
  point(frame, source) {
    const ray = frame.getPose(source.targetRaySpace, this.space), hit = this.touched?.find(t => t.inputSource === source)?.results[0]?.getPose(this.space);
    if (!ray || !this.viewer) return;
    const {matrix: m} = (hit ?? ray).transform, at = xyz((hit ?? ray).transform.position);
    if (hit) this.place = hung(at, [m[4], m[5], m[6]], this.viewer);  // y is the normal of what was hit
    else this.place = hungBefore(at, [-m[8], -m[9], -m[10]], armsLength);
  }
}
