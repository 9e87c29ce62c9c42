// strokes.js: what a hand does as lines of a journal (docs/reference/journal-format.md): places in mm, pressure, tilt.

import {degree} from './shared/placement.js';

const rounded = (value, digits) => +value.toFixed(digits);
const pressedBySpeed = 420;  // [mm/s] at which a quick hand presses least

export class StrokeLines {
  // tool: {brush, paint, finish, load, start, pressure: {from: 'pen' | 'speed' | 'fixed', value}, palette, stabiliser_mm}; `turn`
  // [degrees]: of the view, which turns tilt and twist. place(event) gives [mm] x right, y up, or null.
  constructor(tool, seed, turn, place) {
    Object.assign(this, {tool, turn, place, begun: null, last: null});
    const {brush, paint, finish, load, start, palette, stabiliser} = tool;
    this.first = JSON.stringify({event: 'stroke', brush, ...(palette ? {on: 'palette'} : {}), ...(paint ? {paint, load} : {}), start,
      ...(paint ? finish : {}), ...(stabiliser ? {stabiliser_mm: stabiliser} : {}), seed});
  }
  // Lines of what an event brings, with the points that the browser has put together; those that are off the plane are left out.
  points(event) {
    const all = event.getCoalescedEvents?.() ?? [];
    return (all.length ? all : [event]).map(e => this.point(e)).filter(line => line);
  }
  point(event) {
    const at = this.place(event);
    if (!at) return null;
    this.begun ??= event.timeStamp;
    const time = Math.max((event.timeStamp - this.begun) / 1000, this.last?.time ?? 0);
    const pressure = this.pressure(event, at, time), tilt = this.tilt(event);
    this.last = {at, time, pressure};
    return JSON.stringify({event: 'point', t: rounded(time, 4), x: rounded(at[0], 4), y: rounded(at[1], 4), p: rounded(pressure, 3), ...tilt});
  }
  pressure(event, at, time) {
    const {from, value} = this.tool.pressure;
    if (from === 'pen' && event.pointerType === 'pen') return Math.min(event.pressure * 2 * value, 1);
    if (from !== 'speed') return value;
    if (!this.last || time <= this.last.time) return this.last?.pressure ?? value;
    const speed = Math.hypot(at[0] - this.last.at[0], at[1] - this.last.at[1]) / (time - this.last.time);
    const wanted = value * (1.25 - Math.min(speed / pressedBySpeed, 1)), weight = Math.min((time - this.last.time) / 0.06, 1);
    return Math.min(Math.max(this.last.pressure + weight * (wanted - this.last.pressure), 0.05), 1);
  }
  // The handle's lean towards x and y, and the turn of its width; nothing where the device does not tell.
  tilt(event) {
    if (event.pointerType !== 'pen') return {};
    const right = Math.sin((event.tiltX || 0) * degree), up = -Math.sin((event.tiltY || 0) * degree);
    const a = -this.turn * degree, long = Math.max(Math.hypot(right, up), 1);
    const tx = (Math.cos(a) * right - Math.sin(a) * up) / long, ty = (Math.sin(a) * right + Math.cos(a) * up) / long;
    const r = event.twist ? ((-event.twist - this.turn) % 360 + 540) % 360 - 180 : 0;
    return {...(tx || ty ? {tx: rounded(tx, 4), ty: rounded(ty, 4)} : {}), ...(r ? {r: rounded(r, 2)} : {})};
  }
}
export const endLine = '{"event":"end"}';
