// hand.js: mouse, touch, pen and keys change the state; page.js draws it.

const degreesPerHeight = 120, halfSpeed = 0.15, halfWay = 0.06, sweepSpeed = 40;

class InputController {
  // state: view, tilt, light, tool, …; changed() after every change. fit() shows the whole painting.
  constructor(canvas, state, screen, fit, changed) {
    Object.assign(this, {canvas, state, screen, fit, changed, pointers: new Map(), cursor: null});
    this.still = matchMedia('(prefers-reduced-motion: reduce)').matches;
    canvas.addEventListener('pointerdown', event => this.down(event));
    canvas.addEventListener('pointermove', event => this.move(event));
    for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, event => this.up(event));
    canvas.addEventListener('pointerleave', () => { this.cursor = null; this.changed(); });
    canvas.addEventListener('contextmenu', event => event.preventDefault());
    canvas.addEventListener('wheel', event => this.wheel(event), {passive: false});
    canvas.addEventListener('dblclick', event => this.zoom(2, this.place(event)));
  }
  get holds() { return this.pointers.size > 0; }
  placement() { return new Placement(this.state.view, this.state.tilt, this.screen()); }
  place(event) {
    const box = this.canvas.getBoundingClientRect(), screen = this.screen();
    return [(event.clientX - box.left) * screen.width / box.width, (event.clientY - box.top) * screen.height / box.height];
  }
  zoom(factor, [x, y]) {
    this.state.view = zoomed(this.state.view, factor, x, y, this.screen());
    this.changed();
  }
  wheel(event) {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 16 : event.deltaMode === 2 ? 400 : 1;
    this.zoom(Math.exp(-event.deltaY * lines / (event.ctrlKey ? 100 : 700)), this.place(event));
  }

  down(event) {
    document.activeElement?.blur();  // keys are the picture's again
    this.canvas.setPointerCapture(event.pointerId);
    const at = this.place(event), {state} = this;
    this.pointers.set(event.pointerId, at);
    this.last = performance.now();
    if (this.pointers.size > 1) {
      if (this.drag === 'light') state.light = this.before;  // the first finger did not mean it
      this.drag = 'pinch';
      return;
    }
    this.before = state.light;
    this.drag = event.button === 2 ? 'tilt' : event.button === 1 || this.space ? 'pan' : state.tool;
    state.tilt = {...state.tilt, vx: 0, vy: 0, returning: false};
    if (this.drag === 'light') this.aim(at);
    if (this.drag === 'ruler') {
      const from = this.placement().toPainting(...at);
      state.ruler = from && [from, from];
    }
    this.changed();
  }
  move(event) {
    const at = this.place(event), before = this.pointers.get(event.pointerId);
    this.cursor = at;
    if (before) this.follow(event.pointerId, before, at);
    this.changed();
  }
  follow(id, before, at) {
    const {state} = this, by = [at[0] - before[0], at[1] - before[1]], screen = this.screen();
    const now = performance.now(), seconds = Math.max((now - this.last) / 1000, 1e-3);
    this.last = now;
    if (this.drag === 'pinch') {
      const other = [...this.pointers.entries()].find(([key]) => key !== id)?.[1];
      this.pointers.set(id, at);
      if (!other) return;
      const distance = p => Math.max(Math.hypot(p[0] - other[0], p[1] - other[1]), 1);
      const middle = [(at[0] + other[0]) / 2, (at[1] + other[1]) / 2];
      state.view = panned(state.view, by[0] / 2, by[1] / 2);
      state.view = zoomed(state.view, distance(at) / distance(before), ...middle, screen);
      return;
    }
    this.pointers.set(id, at);
    if (this.drag === 'light') this.aim(at);
    if (this.drag === 'pan') state.view = panned(state.view, ...by);
    if (this.drag === 'tilt') this.turn(by[0] / screen.height, by[1] / screen.height, seconds);
    if (this.drag === 'ruler' && state.ruler) {
      const to = this.placement().toPainting(...at);
      if (to) state.ruler = [state.ruler[0], to];
    }
  }
  up(event) {
    this.pointers.delete(event.pointerId);
    if (this.drag === 'tilt' && performance.now() - this.last > 80) this.state.tilt = {...this.state.tilt, vx: 0, vy: 0};
    if (this.drag === 'pinch') this.drag = 'pan';
    if (!this.pointers.size) this.drag = null;
    this.changed();
  }
  aim(at) {
    const screen = this.screen(), radius = Math.min(screen.width, screen.height) / 2;
    this.state.sweeping = false;
    this.state.light = lightAt((at[0] - screen.width / 2) / radius, (screen.height / 2 - at[1]) / radius);
  }
  // Thesis eq. 3.10 to 3.13: dragging over the height of the screen turns by 120 degrees.
  turn(right, down, seconds) {
    const {tilt} = this.state, x = degreesPerHeight * down, y = degreesPerHeight * right, weight = Math.min(seconds / 0.1, 1);
    this.state.tilt = {x: clamp(tilt.x + x, -mostTilt, mostTilt), y: clamp(tilt.y + y, -mostTilt, mostTilt), returning: false,
      vx: tilt.vx + weight * (x / seconds - tilt.vx), vy: tilt.vy + weight * (y / seconds - tilt.vy)};
  }
  // What goes on by itself; true while something does.
  advance(seconds) {
    const {state} = this, {tilt} = state;
    if (state.sweeping) state.light = {...state.light, azimuth: (state.light.azimuth + sweepSpeed * seconds + 180) % 360 - 180};
    if (tilt.returning) {
      const part = this.still ? 0 : 2 ** (-seconds / halfWay), x = tilt.x * part, y = tilt.y * part;
      state.tilt = Math.hypot(x, y) < 0.05 ? {x: 0, y: 0, vx: 0, vy: 0, returning: false} : {...tilt, x, y};
      return true;
    }
    if (!this.holds && (tilt.vx || tilt.vy)) {
      const slower = 2 ** (-seconds / halfSpeed), way = this.still ? 0 : halfSpeed / Math.LN2 * (1 - slower);
      const stops = this.still || Math.hypot(tilt.vx, tilt.vy) * slower < 1;
      state.tilt = {x: clamp(tilt.x + way * tilt.vx, -mostTilt, mostTilt), y: clamp(tilt.y + way * tilt.vy, -mostTilt, mostTilt),
        vx: stops ? 0 : tilt.vx * slower, vy: stops ? 0 : tilt.vy * slower, returning: false};
      return true;
    }
    return state.sweeping;
  }

  // Keys on the picture; true where one is ours.
  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return false;
    const {state} = this, screen = this.screen(), middle = [screen.width / 2, screen.height / 2];
    const arrows = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]}[event.key];
    if (arrows) {
      const [x, y] = arrows;
      if (event.shiftKey) {
        state.tilt = {...state.tilt, x: clamp(state.tilt.x - 3 * y, -mostTilt, mostTilt), y: clamp(state.tilt.y + 3 * x, -mostTilt, mostTilt)};
      } else if (state.tool === 'pan') {
        state.view = panned(state.view, -60 * x, 60 * y);
      } else {
        state.sweeping = false;
        state.light = {azimuth: (state.light.azimuth + 3 * x + 540) % 360 - 180, elevation: clamp(state.light.elevation + 3 * y, lowestLight, 90)};
      }
      return true;
    }
    const tools = {l: 'light', t: 'tilt', h: 'pan', m: 'ruler'}, key = event.key.toLowerCase();
    if (tools[key]) state.tool = tools[key];
    else if (key === '+' || key === '=') this.zoom(1.25, middle);
    else if (key === '-') this.zoom(0.8, middle);
    else if (key === 'f') this.fit();
    else if (key === '1') this.zoom(1 / state.view.zoom, middle);
    else if (key === ',' || key === '.') state.view = {...state.view, turn: state.view.turn + (key === ',' ? 15 : -15)};
    else if (key === 'r') Object.assign(state, {tilt: {...state.tilt, vx: 0, vy: 0, returning: true}, view: {...state.view, turn: 0}});
    else if (key === 's') state.shadows = !state.shadows;
    else if (key === 'o') state.loupe = !state.loupe;
    else if (key === 'escape') state.ruler = null;
    else return false;
    return true;
  }
}
