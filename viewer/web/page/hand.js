// hand.js: mouse, touch, pen and keys change the state; page.js draws it.

import {Drag, arrowOf, goesOn, steppedLight, still, wantsCalm, wheeled} from './moves.js';
import {Placement, clamp, mostTilt, panned, pinched, zoomed} from './placement.js';

export class InputController {
  // state: view, tilt, held, light, tool, …; changed() after every change. screen: Screen; pen: MarkPen.
  constructor(picture, state, screen, pen, changed) {
    const {canvas} = screen;
    Object.assign(this, {canvas, picture, state, screen, pen, changed, pointers: new Map(), cursor: null, dragged: null});
    this.calm = wantsCalm();
    canvas.addEventListener('pointerdown', event => this.down(event));
    canvas.addEventListener('pointermove', event => this.move(event));
    for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, event => this.up(event));
    canvas.addEventListener('pointerleave', () => { this.cursor = null; this.changed(); });
    canvas.addEventListener('contextmenu', event => event.preventDefault());
    canvas.addEventListener('wheel', event => this.wheel(event), {passive: false});
    canvas.addEventListener('dblclick', event => { if (!pen.draws) this.zoom(2, screen.at(event)); });
  }
  get holds() { return this.pointers.size > 0; }
  // What is dragged: 'light', 'tilt', 'pan', 'pinch', 'ruler', 'mark'; nothing where no hand is on it.
  get drag() { return this.dragged?.kind; }
  placement() { return new Placement(this.picture, this.state.view, this.state.tilt, this.screen, this.state.held); }
  // [CSS pixels] Of two places on the painting, as it is seen.
  distance(a, b) {
    const placement = this.placement(), [p, q] = [a, b].map(at => placement.toScreen(...at));
    return Math.hypot(p[0] - q[0], p[1] - q[1]) * this.screen.css;
  }
  zoom(factor, [x, y]) {
    this.state.view = zoomed(this.state.view, factor, x, y, this.screen);
    this.changed();
  }
  wheel(event) {
    event.preventDefault();
    this.state.view = wheeled(this.state.view, event, this.screen.at(event), this.screen);
    this.changed();
  }

  down(event) {
    document.activeElement?.blur();  // keys are the picture's again
    this.canvas.setPointerCapture(event.pointerId);
    const at = this.screen.at(event), {state} = this;
    this.pointers.set(event.pointerId, at);
    if (this.pointers.size > 1) {
      if (this.drag === 'light') state.light = this.before;  // the first finger did not mean it
      if (this.drag === 'mark') this.pen.undo();
      this.dragged = new Drag('pinch', at);
      return;
    }
    this.before = state.light;
    this.dragged = new Drag(event.button === 2 ? 'tilt' : event.button === 1 ? 'pan' : this.pen.draws ? 'mark' : state.tool, at);
    state.tilt = {...state.tilt, vx: 0, vy: 0, returning: false};
    if (this.drag === 'light') this.dragged.follow(state, this.picture, this.screen, at);
    if (this.drag === 'ruler') {
      const from = this.placement().toPainting(...at);
      Object.assign(state, {ruler: from && [from, from], cross: null, measuring: false});
    }
    this.mark(at, (place, distance) => this.pen.down(place, distance));
    this.changed();
  }
  move(event) {
    const at = this.screen.at(event), before = this.pointers.get(event.pointerId);
    this.cursor = at;
    if (before) this.follow(event.pointerId, before, at);
    this.changed();
  }
  follow(id, before, at) {
    const {state, screen} = this;
    this.pointers.set(id, at);
    if (this.drag === 'pinch') {
      const other = [...this.pointers.entries()].find(([key]) => key !== id)?.[1];
      if (other) state.view = pinched(this.picture, state.view, [before, other], [at, other], screen);
      return;
    }
    this.dragged.follow(state, this.picture, screen, at);
    if (this.drag === 'ruler' && state.ruler) {
      const to = this.placement().toPainting(...at);
      if (to) state.ruler = [state.ruler[0], to];
    }
    this.mark(at, place => this.pen.move(place));
  }
  // The pen takes it, where it draws and there is painting.
  mark(at, take) {
    const place = this.drag === 'mark' ? this.placement().toPainting(...at) : null;
    if (place) take(place, (a, b) => this.distance(a, b));
  }
  up(event) {
    this.pointers.delete(event.pointerId);
    if (this.drag === 'mark') this.pen.up((a, b) => this.distance(a, b));
    this.dragged?.end(this.state);
    const [left] = this.pointers.values();
    if (!left) this.dragged = null;
    else if (this.drag === 'pinch') this.dragged = new Drag('pan', left);  // with the finger that stays
    this.changed();
  }
  // What goes on by itself; true while something does.
  advance(seconds) { return goesOn(this.state, seconds, this.holds, this.calm); }

  // Keys on the picture; true where one is ours.
  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return false;
    if (this.pen.key(event, this.placement(), this.screen.css)) return true;
    const {state, screen} = this, middle = [screen.width / 2, screen.height / 2];
    const arrows = arrowOf(event);
    if (arrows) {
      const [x, y] = arrows;
      if (event.shiftKey) {
        state.tilt = {...state.tilt, x: clamp(state.tilt.x - 3 * y, -mostTilt, mostTilt), y: clamp(state.tilt.y + 3 * x, -mostTilt, mostTilt)};
      } else if (state.tool === 'pan') {
        state.view = panned(this.picture, state.view, -60 * x, 60 * y);
      } else {
        state.sweeping = false;
        state.light = steppedLight(state.light, arrows);
      }
      return true;
    }
    const tools = {l: 'light', t: 'tilt', h: 'pan', m: 'ruler'}, key = event.key.toLowerCase();
    if (tools[key]) state.tool = tools[key];
    else if (key === '+' || key === '=') this.zoom(1.25, middle);
    else if (key === '-') this.zoom(0.8, middle);
    else if (key === 'f') screen.fit();
    else if (key === '1') this.zoom(1 / state.view.zoom, middle);
    else if (key === ',' || key === '.') state.view = {...state.view, turn: state.view.turn + (key === ',' ? 15 : -15)};
    else if (key === 'r') Object.assign(state, {tilt: {...still, x: state.tilt.x, y: state.tilt.y, returning: true}, view: {...state.view, turn: 0}});
    else if (key === 's') state.shadows = !state.shadows;
    else if (key === 'o') state.loupe = !state.loupe;
    else if (key === 'escape') state.ruler = null;
    else return false;
    return true;
  }
}
