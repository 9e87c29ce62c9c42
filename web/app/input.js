// input.js: pen, fingers and mouse on the painting. One finger or the pen does what the tool does; two move, zoom and turn the
// painting; two or three that only tap undo and redo. While a pen is near, fingers and palm do nothing.

import {Drag, isWheel, scrolled, wheeled} from './shared/moves.js';
import {pinched} from './shared/placement.js';

const penRests = 1200, meantAfter = 70, meantBeyond = 6, tapTime = 280, tapWay = 14;  // [ms], [ms], [CSS pixels], [ms], [CSS pixels]

export class Input {
  // on: {tool(): 'paint' | 'sample' | 'light' | 'tilt' | 'pan', begin(event) -> stroke or null, add(stroke, event), end(stroke, event),
  // drop(stroke), sample(event), undo(), redo(), changed(), tip(event or null)}; view: View.
  constructor(canvas, on) {
    Object.assign(this, {canvas, on, view: null, touches: new Map(), stroke: null, held: [], penSeen: -Infinity});
    const listen = (name, work, options) => canvas.addEventListener(name, event => { if (this.view) work.call(this, event); }, options);
    listen('pointerdown', this.down);
    listen('pointermove', this.move);
    listen('pointerup', this.up);
    listen('pointercancel', this.cancel);
    listen('pointerleave', event => { if (event.pointerType !== 'touch') on.tip(null); });
    listen('wheel', this.wheel, {passive: false});
    canvas.addEventListener('contextmenu', event => event.preventDefault());
    // Safari's own gestures, which would zoom the page.
    for (const name of ['gesturestart', 'gesturechange', 'dblclick']) document.addEventListener(name, event => event.preventDefault(), {passive: false});
  }
  get holds() { return this.stroke !== null; }
  get penIsNear() { return performance.now() - this.penSeen < penRests; }

  down(event) {
    event.preventDefault();
    document.activeElement?.blur();
    this.canvas.setPointerCapture(event.pointerId);
    if (event.pointerType === 'pen') this.penSeen = performance.now();
    if (event.pointerType === 'touch') this.touchDown(event);
    else this.begin(event);
  }
  move(event) {
    if (event.pointerType === 'pen') this.penSeen = performance.now();
    if (event.pointerType === 'touch') {
      this.touchMove(event);
      return;
    }
    this.on.tip(event);
    if (this.stroke?.id === event.pointerId) this.follow(event);
  }
  up(event) {
    if (event.pointerType === 'pen') this.penSeen = performance.now();
    if (event.pointerType === 'touch') this.touchUp(event, false);
    else if (this.stroke?.id === event.pointerId) this.end(event);
  }
  cancel(event) {
    if (event.pointerType === 'touch') this.touchUp(event, true);
    else if (this.stroke?.id === event.pointerId) this.end(event);
  }

  // What one pointer does, from here on: a stroke, or the light, the tilt, the place.
  begin(event) {
    this.does(event, event.button === 2 ? 'tilt' : event.button === 1 ? 'pan' : event.button === 5 ? 'erase' : this.on.tool());
  }
  does(event, tool) {
    const paints = tool === 'paint' || tool === 'erase';
    this.stroke = {id: event.pointerId, tool, drag: new Drag(tool, this.view.screen.at(event)), lines: paints ? this.on.begin(event, tool === 'erase') : null};
    if (tool === 'sample') this.on.sample(event);
    if (tool === 'light') this.drags(event);
  }
  follow(event) {
    const {stroke} = this;
    if (stroke.lines) this.on.add(stroke.lines, event);
    else if (stroke.tool === 'sample') this.on.sample(event);
    else this.drags(event);
  }
  drags(event) {
    const {view} = this;
    this.stroke.drag.follow(view.state, view.picture, view.screen, view.screen.at(event));
    this.on.changed();
  }
  end(event) {
    const {stroke} = this;
    this.stroke = null;
    if (stroke.lines) {
      this.on.end(stroke.lines, event);
    } else {
      stroke.drag.end(this.view.state);
      this.on.changed();
    }
  }

  // A finger's first moments are held back: a second one may follow, and then none of them meant to paint.
  touchDown(event) {
    if (this.penIsNear) return;
    const at = this.view.screen.at(event);
    this.touches.set(event.pointerId, {at, from: [event.clientX, event.clientY]});
    if (this.touches.size === 1) {
      Object.assign(this, {gesture: {begun: performance.now(), fingers: 1, way: 0, kind: 'waits'}, held: [event]});
      clearTimeout(this.meant);
      this.meant = setTimeout(() => this.mean(), meantAfter);
      return;
    }
    const {gesture} = this;
    if (!gesture || gesture.kind === 'one') return;  // a stroke is under way: the hand that rests
    clearTimeout(this.meant);
    Object.assign(gesture, {kind: 'many', fingers: Math.max(gesture.fingers, this.touches.size)});
    this.held = [];
  }
  // It was meant.
  mean() {
    const {gesture, held} = this;
    if (gesture?.kind !== 'waits' || !held.length) return;
    clearTimeout(this.meant);
    gesture.kind = 'one';
    this.held = [];
    this.begin(held[0]);
    for (const event of held.slice(1)) if (this.stroke) this.follow(event);
  }
  touchMove(event) {
    const touch = this.touches.get(event.pointerId), {gesture} = this;
    if (!touch) return;
    const at = this.view.screen.at(event), way = Math.hypot(event.clientX - touch.from[0], event.clientY - touch.from[1]);
    gesture.way = Math.max(gesture.way, way);
    if (gesture.kind === 'waits') {
      this.held.push(event);
      if (way > meantBeyond) this.mean();
    } else if (gesture.kind === 'many' && this.touches.size >= 2) {
      const [first, second] = [...this.touches.keys()], other = event.pointerId === first ? second : first;
      if (event.pointerId === first || event.pointerId === second) {
        const {state} = this.view, still = this.touches.get(other).at;
        if (gesture.way <= tapWay) return;  // it may be a tap; if not, it counts from where it began
        state.view = pinched(this.view.picture, state.view, [touch.at, still], [at, still], this.view.screen);
        this.on.changed();
      }
    } else if (this.stroke?.id === event.pointerId) {
      this.follow(event);
    }
    touch.at = at;
  }
  touchUp(event, cancelled) {
    if (!this.touches.delete(event.pointerId)) return;
    const {gesture} = this;
    if (gesture.kind === 'waits') {
      if (cancelled) this.held = [];
      else this.mean();
    }
    if (this.stroke?.id === event.pointerId) this.end(event);
    if (this.touches.size) return;
    if (gesture.kind === 'many' && !cancelled && gesture.way < tapWay && performance.now() - gesture.begun < tapTime + 100 * gesture.fingers) {
      if (gesture.fingers === 2) this.on.undo();
      if (gesture.fingers === 3) this.on.redo();
    }
    this.gesture = null;
  }

  wheel(event) {
    event.preventDefault();
    const {view} = this, {state} = view;
    if (isWheel(event)) state.view = wheeled(state.view, event, view.screen.at(event), view.screen);
    else state.view = scrolled(view.picture, state.view, event, 1 / view.screen.css);
    this.on.changed();
  }
}
