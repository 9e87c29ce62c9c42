// screen.js: a canvas as a screen: how many pixels it has, the view that shows the whole painting on it, and tiles for it.

import {clamp, fitted} from './placement.js';
import {tileSide} from './tiles.js';

const mostPixels = 3;  // of the device for one of CSS: more is finer than eyes are at an arm's length

export class Screen {
  // picture: as Placement has it; state.view: what is shown, kept as it is where it is `placed` already. free(): the rectangles
  // that panes leave free, or nothing; changed() after it was resized.
  constructor(canvas, picture, state, {free, changed, placed = false}) {
    Object.assign(this, {canvas, picture, state, free, changed, placed, width: 1, height: 1, observer: new ResizeObserver(() => this.resized())});
  }
  get ratio() { return Math.min(devicePixelRatio || 1, mostPixels); }
  // [CSS pixels] of one of its pixels.
  get css() { return this.canvas.clientWidth / this.width; }
  // Tiles to be kept for it: twice what it shows at once, and coarser ones that stand in.
  get tiles() { return clamp(Math.round(5 * this.canvas.clientWidth * this.canvas.clientHeight * this.ratio ** 2 / tileSide ** 2) + 24, 64, 512); }
  // Its pixel, of a pointer's event.
  at(event) {
    const box = this.canvas.getBoundingClientRect();
    return [(event.clientX - box.left) * this.width / box.width, (event.clientY - box.top) * this.height / box.height];
  }

  // Follows the canvas from here on.
  observe() {
    this.resized();
    this.observer.observe(this.canvas);
  }
  close() { this.observer.disconnect(); }
  resized() {
    const {canvas, ratio} = this, pixels = css => Math.max(1, Math.round(css * ratio));
    Object.assign(this, {width: pixels(canvas.clientWidth), height: pixels(canvas.clientHeight)});
    this.refit();
  }
  // Other rectangles are free: the whole painting moves there, where nobody has moved it.
  refit() {
    if (!this.placed || this.state.view === this.whole) this.fit();
    this.placed = true;
    this.changed();
  }
  fit() {
    this.state.view = fitted(this.picture, this, this.state.view?.turn ?? 0, this.free());
    this.whole = this.state.view;
  }
  // The whole canvas as a rectangle, with `part` of the screen's pixels on each side.
  rectangle(part) {
    const {canvas} = this, width = Math.max(1, Math.round(this.width * part)), height = Math.max(1, Math.round(this.height * part));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, {width, height});
    return {left: 0, bottom: 0, width, height};
  }
}
