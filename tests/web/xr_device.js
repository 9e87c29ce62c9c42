// xr_device.js: a stand-in for a device of WebXR with one eye. Tests set what it knows in window.xr, call xr.frame(), and read what it
// then shows in xr.pixels(). Matrices are 4 x 4, column by column; heads and rays look along -z.
(() => {
  const unmoved = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1], source = {targetRaySpace: {}}, probe = {probeSpace: {}};
  const xr = window.xr = {supported: ['immersive-ar'], refuses: null, width: 400, height: 300, projection: unmoved, head: unmoved, ray: unmoved, hit: null, light: null, session: null};
  const rigid = m => {
    const turned = [m[0], m[4], m[8], 0, m[1], m[5], m[9], 0, m[2], m[6], m[10], 0], back = [0, 1, 2].map(r => -(turned[r] * m[12] + turned[4 + r] * m[13] + turned[8 + r] * m[14]));
    return {matrix: m, position: {x: m[12], y: m[13], z: m[14], w: 1}, inverse: {matrix: [...turned, ...back, 1]}};
  };
  const frame = {
    getViewerPose: () => ({transform: rigid(xr.head), views: [{eye: 'none', projectionMatrix: xr.projection, transform: rigid(xr.head)}]}),
    getPose: space => ({transform: rigid(space === source.targetRaySpace ? xr.ray : unmoved)}),
    getHitTestResultsForTransientInput: () => xr.hit ? [{inputSource: source, results: [{getPose: () => ({transform: rigid(xr.hit)})}]}] : [],
    getLightEstimate: () => xr.light && ({primaryLightDirection: xr.light, primaryLightIntensity: {x: 1, y: 1, z: 1, w: 1}}),
  };
  class Session extends EventTarget {
    requestAnimationFrame(draw) { this.next = draw; }
    updateRenderState({baseLayer}) { xr.layer = baseLayer; }
    async requestReferenceSpace() { return {}; }
    async requestHitTestSourceForTransientInput() { return {}; }
    async requestLightProbe() { return probe; }
    async end() { this.dispatchEvent(new Event('end')); }
  }
  window.XRWebGLLayer = class {
    constructor(session, gl) {
      Object.assign(this, {gl, framebuffer: gl.createFramebuffer()});
      gl.bindFramebuffer(gl.FRAMEBUFFER, this.framebuffer);
      for (const [format, place] of [[gl.RGBA8, gl.COLOR_ATTACHMENT0], [gl.DEPTH24_STENCIL8, gl.DEPTH_STENCIL_ATTACHMENT]]) {
        const buffer = gl.createRenderbuffer();
        gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
        gl.renderbufferStorage(gl.RENDERBUFFER, format, xr.width, xr.height);
        gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, buffer);
      }
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    }
    getViewport() { return {x: 0, y: 0, width: xr.width, height: xr.height}; }
  };
  WebGL2RenderingContext.prototype.makeXRCompatible = async () => {};
  Object.assign(xr, {
    frame() { xr.session.next(0, frame); },
    select() { xr.session.dispatchEvent(Object.assign(new Event('select'), {frame, inputSource: source})); },
    // RGBA, from the lower left corner.
    pixels() {
      const {gl, framebuffer} = xr.layer, bytes = new Uint8Array(4 * xr.width * xr.height);
      gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
      gl.readPixels(0, 0, xr.width, xr.height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
      return Array.from(bytes);
    },
  });
  Object.defineProperty(navigator, 'xr', {value: {
    isSessionSupported: async mode => xr.supported.includes(mode),
    requestSession: async (mode, options) => {
      if (xr.refuses) throw new DOMException(xr.refuses, 'NotAllowedError');
      return Object.assign(xr, {session: new Session(), options}).session;
    },
  }});
})();
