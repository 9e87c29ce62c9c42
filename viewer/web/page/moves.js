// moves.js: what hands, wheels and keys do to view, tilt and light: of the exported page and of the application.

import {clamp, lightAt, lowestLight, mostTilt, panned, zoomed} from './placement.js';

const degreesPerHeight = 120, halfSpeed = 0.15, halfWay = 0.06, sweepSpeed = 40;  // [degrees], [s], [s], [degrees/s]
const restsBefore = 80;  // [ms]
const domeRadius = 0.46;  // of the picture of the dome, in its width
export const still = {x: 0, y: 0, vx: 0, vy: 0, returning: false};  // a painting that is not tilted, and rests

// Light from a place on the screen, where a dome stands that touches the nearer edges; from a place on a picture of the dome.
function aimed(screen, [x, y]) {
  const radius = Math.min(screen.width, screen.height) / 2;
  return lightAt((x - screen.width / 2) / radius, (screen.height / 2 - y) / radius);
}
export function aimedOnDome(dome, event) {
  const box = dome.getBoundingClientRect();
  return lightAt(((event.clientX - box.left) / box.width - 0.5) / domeRadius, (0.5 - (event.clientY - box.top) / box.height) / domeRadius);
}
// The arrow of a key: right, up; null for any other key.
export const arrowOf = event => ({ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]})[event.key] ?? null;
export const steppedLight = ({azimuth, elevation}, [x, y]) => ({azimuth: (azimuth + 3 * x + 540) % 360 - 180, elevation: clamp(elevation + 3 * y, lowestLight, 90)});

// A wheel zooms about what is under it.
export function wheeled(view, event, at, screen) {
  const lines = event.deltaMode === 1 ? 16 : event.deltaMode === 2 ? 400 : 1;
  return zoomed(view, Math.exp(-event.deltaY * lines / (event.ctrlKey ? 100 : 700)), ...at, screen);
}
// A trackpad's two fingers zoom where they pinch, and else move.
export const isWheel = event => event.ctrlKey || Number.isInteger(event.deltaY) && !event.deltaX;
export const scrolled = (picture, view, event, ratio) => panned(picture, view, -event.deltaX * ratio, -event.deltaY * ratio);

// Thesis eq. 3.10 to 3.13: dragging over the height of the screen, `right` and `down` in parts of it, turns by 120 degrees.
function tilted(tilt, right, down, seconds) {
  const x = degreesPerHeight * down, y = degreesPerHeight * right, weight = Math.min(seconds / 0.1, 1), within = v => clamp(v, -mostTilt, mostTilt);
  return {x: within(tilt.x + x), y: within(tilt.y + y), returning: false, vx: tilt.vx + weight * (x / seconds - tilt.vx), vy: tilt.vy + weight * (y / seconds - tilt.vy)};
}

// What goes on by itself, `seconds` later: a tilt that swings on or returns, unless a hand holds it, and a light that sweeps. True
// while something does. `calm`: it is at its end at once.
export function goesOn(state, seconds, holds, calm) {
  const {tilt} = state;
  if (state.sweeping) state.light = {...state.light, azimuth: (state.light.azimuth + sweepSpeed * seconds + 180) % 360 - 180};
  if (tilt.returning) {
    const part = calm ? 0 : 2 ** (-seconds / halfWay), x = tilt.x * part, y = tilt.y * part;
    state.tilt = Math.hypot(x, y) < 0.05 ? still : {...tilt, x, y};
    return true;
  }
  if (!holds && (tilt.vx || tilt.vy)) {
    const slower = 2 ** (-seconds / halfSpeed), way = calm ? 0 : halfSpeed / Math.LN2 * (1 - slower), within = v => clamp(v, -mostTilt, mostTilt);
    const stops = calm || Math.hypot(tilt.vx, tilt.vy) * slower < 1;
    state.tilt = {x: within(tilt.x + way * tilt.vx), y: within(tilt.y + way * tilt.vy), vx: stops ? 0 : tilt.vx * slower, vy: stops ? 0 : tilt.vy * slower, returning: false};
    return true;
  }
  return Boolean(state.sweeping);
}
// A pointer's drag from a place on the screen, which aims the light, tilts or moves the painting: kind 'light', 'tilt' or 'pan'. Any
// other changes nothing here.
export class Drag {
  constructor(kind, at) { Object.assign(this, {kind, at, last: performance.now()}); }
  follow(state, picture, screen, at) {
    const now = performance.now(), seconds = Math.max((now - this.last) / 1000, 1e-3), right = at[0] - this.at[0], down = at[1] - this.at[1];
    Object.assign(this, {at, last: now});
    if (this.kind === 'light') Object.assign(state, {sweeping: false, light: aimed(screen, at)});
    if (this.kind === 'pan') state.view = panned(picture, state.view, right, down);
    if (this.kind === 'tilt') state.tilt = tilted(state.tilt, right / screen.height, down / screen.height, seconds);
  }
  // A hand that rested before it let go leaves the painting as it is.
  end(state) { if (this.kind === 'tilt' && performance.now() - this.last > restsBefore) state.tilt = {...state.tilt, vx: 0, vy: 0}; }
}

export const wantsCalm = () => matchMedia('(prefers-reduced-motion: reduce)').matches;
