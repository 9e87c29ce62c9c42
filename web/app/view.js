// view.js: what is drawn when: the painting under its light, as it is moved, turned and held.

import {cameraEye} from './camera.js';
import {Drawing, sceneOf} from './shared/drawing.js';
import {Frames} from './shared/frames.js';
import {goesOn, still, wantsCalm} from './shared/moves.js';
import {Placement, applied, directionOf} from './shared/placement.js';
import {Screen} from './shared/screen.js';

const roomAround = 76, movesFor = 140;  // [CSS pixels] that tools take at the edges, [ms] after what was moved last

export class View {
  // state: {view, tilt, held, light, lightInHand, look, shadows, exposure, ambient, shoulder}. room: RoomLight. holds(): a hand is on
  // it; covered(): the box of a sheet beside which the painting is to be seen, or null.
  constructor(canvas, state, picture, connection, {room, holds, covered}) {
    Object.assign(this, {canvas, state, picture, connection, room, covered, movedAt: -Infinity});
    const calm = wantsCalm();
    this.frames = new Frames({advance: seconds => goesOn(state, seconds, holds(), calm), moving: () => performance.now() - this.movedAt < movesFor,
      draw: (moving, part) => this.draw(moving, part)});
    this.screen = new Screen(canvas, picture, state, {free: () => this.free(), changed: () => this.ask(), placed: Boolean(state.view)});
    this.drawing = new Drawing(canvas, picture, this.screen.tiles, {
      fetch: (tile, width, height) => connection.ask('tile', {...tile, width, height}), changed: () => this.ask(), missed: () => {},
      left: name => connection.leave(name)});
    this.screen.observe();
  }
  close() {
    this.closed = true;
    this.frames.stop();
    this.screen.close();
    this.drawing.gl.deleteTexture(this.drawing.tiles.texels);
    if (this.drawing.horizon) this.drawing.gl.deleteTexture(this.drawing.horizon);
  }
  // What tools at the edges leave free.
  free() {
    const {width, height, css} = this.screen, margin = roomAround / css, sheet = this.covered();
    // On a low screen they stand at the left (app.css).
    const low = matchMedia('(min-width: 560px) and (max-height: 520px)').matches;
    const all = low ? {x0: 1.55 * margin, y0: 0.85 * margin, x1: width - 0.1 * margin, y1: height - 0.1 * margin} :
      {x0: 0, y0: margin, x1: width, y1: Math.max(height - 1.15 * margin, 2 * margin)};
    return sheet ? [{...all, y1: Math.min(all.y1, sheet.top / css)}, {...all, x1: Math.min(all.x1, sheet.left / css)}] : [all];
  }
  fit() {
    this.screen.fit();
    this.ask();
  }
  placement() {
    const {view, tilt, held, lightInHand} = this.state, {picture, screen, room: {video}} = this;
    if (this.inRoom) return new Placement(picture, view, tilt, screen, undefined, {held: held ?? undefined, eye: cameraEye(video, screen)});
    return new Placement(picture, view, tilt, screen, lightInHand ? undefined : held ?? undefined);
  }
  // The camera's picture of the room is behind the painting.
  get inRoom() { return this.room.away && this.room.video.videoWidth > 0; }
  // Of the canvas only the painting is seen before the room.
  cut(placement) {
    const corners = this.inRoom ? placement.corners() ?? [] : null, {css} = this.screen;
    this.canvas.style.clipPath = corners ? `polygon(${corners.map(p => p.map(v => `${(v * css).toFixed(1)}px`).join(' ')).join(', ') || '0 0'})` : '';
  }
  // [mm] from the middle of the painting, x right, y up, of a pointer event; null beside its plane.
  place(event) {
    const at = this.placement().toPainting(...this.screen.at(event)), {width, height, mm_per_pixel: mm} = this.picture;
    return at && [(at[0] - (width - 1) / 2) * mm, ((height - 1) / 2 - at[1]) * mm];
  }
  // [CSS pixels] that a length on the painting is long on the screen.
  cssOf(mm) { return mm / this.picture.mm_per_pixel * this.state.view.zoom * this.screen.css; }

  scene(placement) {
    const {state} = this, inRoom = directionOf(state.light);
    // In the hand, it is the light that moves: as if the screen were its lamp.
    const light = state.lightInHand && state.held ? applied(state.held, inRoom) : inRoom;
    return this.sceneUnder(placement.inSurface(light));
  }
  // Under a light from there, in the painting's frame.
  sceneUnder(light) { return sceneOf(this.picture, this.state, light); }
  draw(moving, part) {
    const {drawing} = this, camera = this.placement();
    this.cut(camera);
    drawing.show(this.scene(camera), [{camera, rectangle: this.screen.rectangle(part), part, smooth: !moving}]);
    document.documentElement.dataset.drawn = !moving && drawing.tiles.complete ? 'whole' : 'part';
  }
  ask() { this.frames.ask(); }
  // Something moves: coarser, where the machine is slow.
  moving() {
    this.movedAt = performance.now();
    this.ask();
  }
  take(parts) {
    for (const {level, region, texels} of parts) this.drawing.tiles.update(level, region, texels);
    this.ask();
  }
  async loadHorizon(side = 384) {
    const {width, height, values} = await this.connection.ask('horizon', {side});
    if (!this.closed && width > 0) this.drawing.setHorizon(width, height, 16, values);
  }
  // A PNG of the whole painting as it is lit now, one pixel as one, `most` pixels wide or high at most.
  async snapshot(most = 4096) {
    const {width, height} = this.picture, zoom = Math.min(1, most / Math.max(width, height));
    const size = {width: Math.round(width * zoom), height: Math.round(height * zoom)}, view = {x: (width - 1) / 2, y: (height - 1) / 2, zoom, turn: 0};
    const camera = new Placement(this.picture, view, still, size, this.state.held ?? undefined), shot = {camera, rectangle: {left: 0, bottom: 0, ...size}, part: 1, smooth: true};
    for (let tries = 400; tries > 0; --tries) {
      Object.assign(this.canvas, size);  // frames have it as large as the screen
      this.drawing.show(this.scene(camera), [shot]);
      if (this.drawing.tiles.complete) break;
      await new Promise(resolve => setTimeout(resolve, 25));
    }
    const blob = await new Promise(resolve => this.canvas.toBlob(resolve, 'image/png'));  // in the same task: WebGL keeps its picture no longer
    this.ask();
    return blob;
  }
}
