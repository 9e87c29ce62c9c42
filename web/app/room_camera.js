// room_camera.js: a painting at its place in a room, and how an eye there sees it: what Placement is for a painting on a screen. The
// room's frame is that of WebXR: metres, y up.

import {applied, clamp, inverse, times, transposed} from './shared/placement.js';

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = v => v.map(x => x / Math.hypot(...v));
const difference = (a, b) => a.map((v, i) => v - b[i]);
export const xyz = ({x, y, z}) => [x, y, z];

// Where a painting is whose middle is there and whose front looks that way: {middle, axes: its right, up and front as columns}. On
// a wall it hangs upright; on a table, or a floor, its top is away from the viewer.
export function hung(middle, front, viewer) {
  const out = unit(front), lies = Math.abs(out[1]) > Math.SQRT1_2, [x, , z] = difference(middle, viewer);
  const right = unit(cross(lies ? [x, 0, z] : [0, 1, 0], out));
  return {middle, axes: [...right, ...cross(out, right), ...out]};
}
// As far before a viewer who looks that way, upright, and towards him.
export function hungBefore(viewer, looks, metres) {
  const ahead = unit(Math.abs(looks[1]) > 0.99 ? [0, 0, -1] : [looks[0], 0, looks[2]]);
  return hung(viewer.map((v, i) => v + metres * ahead[i]), ahead.map(v => -v), viewer);
}

export class RoomCamera {
  // picture: as Placement has it. place: hung(). eye: an XRView: projectionMatrix, and transform, the eye's place in the room.
  // viewport: {width} [pixels], where it is seen.
  constructor(picture, {middle, axes}, {projectionMatrix: p, transform}, {width: across}) {
    const {width, height, mm_per_pixel} = picture, metres = mm_per_pixel / 1000, [right, up] = [axes.slice(0, 3), axes.slice(3, 6)];
    const corner = middle.map((v, i) => v - (width - 1) / 2 * metres * right[i] + (height - 1) / 2 * metres * up[i]);
    // Of painting's pixels x, y, 1: places in the room, before the eye, and clip coordinates x, y, w.
    const inRoom = [[...right.map(v => v * metres), 0], [...up.map(v => -v * metres), 0], [...corner, 1]];
    const through = (m, v) => [0, 1, 2, 3].map(r => m[r] * v[0] + m[4 + r] * v[1] + m[8 + r] * v[2] + m[12 + r] * v[3]);
    this.toClip = inRoom.flatMap(v => through(p, through(transform.inverse.matrix, v)).filter((_, r) => r !== 2));
    const away = difference(xyz(transform.position), middle);
    Object.assign(this, {picture, axes, zoom: across * p[0] / 2 / Math.hypot(...away) * metres});
    this.eye = [...this.inSurface(away).map(v => 1000 * v), 1];
  }
  inSurface(direction) { return applied(transposed(this.axes), direction); }
  shot(width, height, left = 0, bottom = 0) {
    const toPixel = [width / 2, 0, 0, 0, height / 2, 0, left + width / 2, bottom + height / 2, 1];
    const m = inverse(times(toPixel, this.toClip)), scale = Math.abs(m[8]) || 1;
    return m.map(v => v / scale);
  }
  seen() { return {x0: 0, y0: 0, x1: this.picture.width - 1, y1: this.picture.height - 1}; }
  level(part) { return clamp(Math.round(Math.log2(Math.max(1, 1 / (part * this.zoom)))), 0, this.picture.levels - 1); }
}
