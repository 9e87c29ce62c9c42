// mark_pen.js: drawing points, lines, polygons and texts on the painting, and measuring it, by hand or by keys.

import {arrowOf} from './moves.js';
import {clamp} from './placement.js';

const marking = ['point', 'line', 'polygon', 'text'], near = 22, step = 10;  // [CSS pixels]: half of what a finger hits; of an arrow key

export class MarkPen {
  // state: tool, draft {kind, points}, cross, ruler, view; done(shape) when one is complete; told(text): words for who cannot see it.
  constructor(picture, state, done, told) { Object.assign(this, {picture, state, done, told}); }
  get draws() { return marking.includes(this.state.tool); }

  // `at`, `to`: places on the painting; distance(a, b) of two of them on the screen [CSS pixels].
  down(at, distance) {
    const {state} = this, {tool: kind, draft} = state, points = draft?.kind === kind ? draft.points : [];
    state.cross = null;
    if (kind === 'polygon' && points.length >= 3 && [points[0], points.at(-1)].some(p => distance(p, at) < near)) {
      this.complete(points);
      return;
    }
    const started = kind === 'line' && points.length === 1;
    state.draft = {kind, points: kind === 'line' && !started ? [at, at] : [...points, at], held: true};
  }
  move(to) {
    const {draft} = this.state;
    if (draft?.held) draft.points = [...draft.points.slice(0, -1), to];
  }
  up(distance) {
    const {draft} = this.state;
    if (!draft?.held) return;
    draft.held = false;
    if (draft.kind === 'point' || draft.kind === 'text') this.complete(draft.points);
    if (draft.kind !== 'line') return;
    if (distance(...draft.points) > near / 4) this.complete(draft.points);
    else draft.points = draft.points.slice(0, 1);  // its end is where the next touch is
  }
  // A second finger did not mean it.
  undo() {
    const {draft} = this.state;
    if (draft) this.state.draft = draft.points.length > 1 && draft.kind === 'polygon' ? {...draft, points: draft.points.slice(0, -1), held: false} : null;
  }
  complete(points) {
    const {kind} = this.state.draft ?? {kind: this.state.tool};
    this.state.draft = null;
    this.done({kind, rings: [points]});
  }

  // Keys of these tools; true where one is ours. A crosshair takes the place of the hand.
  key(event, placement, css) {
    const {state} = this, arrows = arrowOf(event), ruler = state.tool === 'ruler';
    if (!this.draws && !ruler) return false;
    if (arrows) this.moveCross(arrows.map(v => v * (event.shiftKey ? 1 : step) / css), placement);
    else if (event.key === 'Enter' || event.key === ' ') (ruler ? this.measure : this.place).call(this, placement, css);
    else if (event.key === 'Escape') Object.assign(state, {draft: null, cross: null, ruler: null, measuring: false});
    else if (event.key === 'Backspace' && state.draft) this.undo();
    else return false;
    return true;
  }
  start(placement) { return this.state.cross ??= placement.toPainting(placement.screen.width / 2, placement.screen.height / 2) ?? [this.state.view.x, this.state.view.y]; }
  moveCross([x, y], placement) {
    const {state, picture} = this, {width, height} = placement.screen, at = placement.toScreen(...this.start(placement));
    const to = placement.toPainting(at[0] + x, at[1] - y) ?? state.cross;
    state.cross = [clamp(to[0], 0, picture.width - 1), clamp(to[1], 0, picture.height - 1)];
    if (state.measuring) state.ruler = [state.ruler[0], state.cross];
    const seen = placement.toScreen(...state.cross);
    if (seen[0] < 0 || seen[1] < 0 || seen[0] > width || seen[1] > height) state.view = {...state.view, x: state.cross[0], y: state.cross[1]};
  }
  measure(placement) {
    const {state} = this, at = this.start(placement);
    if (!state.measuring) state.ruler = [at, at];
    state.measuring = !state.measuring;
    this.told(state.measuring ? 'The line begins here: move its end with the arrow keys, and press Enter.' : 'The line ends here.');
  }
  place(placement, css) {
    const {state} = this, at = this.start(placement), kind = state.tool, points = state.draft?.kind === kind ? state.draft.points : [];
    const distance = (a, b) => Math.hypot(...[0, 1].map(i => placement.toScreen(...a)[i] - placement.toScreen(...b)[i])) * css;
    const closes = kind === 'polygon' && points.length >= 3 && [points[0], points.at(-1)].some(p => distance(p, at) < step / 2);
    if (closes) return this.complete(points);
    state.draft = {kind, points: [...points, at], held: false};
    const wanted = {point: 1, text: 1, line: 2}[kind];
    if (state.draft.points.length === wanted) return this.complete(state.draft.points);
    this.told(`Point ${state.draft.points.length} is placed.${kind === 'polygon' && points.length >= 2 ? ' Press Enter here again to close the polygon.' : ''}`);
  }
}
