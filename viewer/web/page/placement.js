// placement.js: where the painting lies in space, and the light: as viewer/render/view.cpp and tilt.cpp have it.
// Matrices are 3 x 3, column by column. Screen: device pixels from its upper left corner. Painting: pixels, whole
// numbers are centres.
export const degree = Math.PI / 180, eyeHeights = 3, fitMargin = 0.95, lowestLight = 2, mostTilt = 75, leastZoom = 1 / 1024, mostZoom = 64;
export const clamp = (v, low, high) => Math.min(Math.max(v, low), high);

export function times(a, b) {
  const m = [];
  for (let c = 0; c < 3; ++c)
    for (let r = 0; r < 3; ++r) m.push(a[r] * b[3 * c] + a[3 + r] * b[3 * c + 1] + a[6 + r] * b[3 * c + 2]);
  return m;
}
export const applied = (m, v) => [0, 1, 2].map(r => m[r] * v[0] + m[3 + r] * v[1] + m[6 + r] * v[2]);
export const transposed = m => [m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]];
export function inverse(m) {
  const cross = (i, j) => [m[i + 1] * m[j + 2] - m[i + 2] * m[j + 1], m[i + 2] * m[j] - m[i] * m[j + 2], m[i] * m[j + 1] - m[i + 1] * m[j]];
  const rows = [cross(3, 6), cross(6, 0), cross(0, 3)];
  const determinant = m[0] * rows[0][0] + m[1] * rows[0][1] + m[2] * rows[0][2];
  return transposed(rows.flat().map(v => v / determinant));
}
export const rotationX = a => [1, 0, 0, 0, Math.cos(a), Math.sin(a), 0, -Math.sin(a), Math.cos(a)];
export const rotationY = a => [Math.cos(a), 0, -Math.sin(a), 0, 1, 0, Math.sin(a), 0, Math.cos(a)];
export const rotationZ = a => [Math.cos(a), Math.sin(a), 0, -Math.sin(a), Math.cos(a), 0, 0, 0, 1];

const unmoved = [1, 0, 0, 0, 1, 0, 0, 0, 1];

// picture: {width, height [pixels], mm_per_pixel, levels}. view: x, y [its pixels] at the middle of the screen, zoom, turn
// [degrees]. tilt: x, y [degrees]: the painting is drawn as it is turned. held: how the screen itself is held (held.js), which
// turns the painting without its being drawn otherwise: only light and eye move over it. room: {held, eye}: instead the painting
// stays in the room and is seen from an eye, `eye` heights of the screen before it, that turns as the screen is held.
export class Placement {
  constructor(picture, view, tilt, screen, held = unmoved, {held: turned = unmoved, eye: heights = eyeHeights} = {}) {
    this.picture = picture;
    this.view = view;
    this.screen = screen;
    const turn = rotationZ(view.turn * degree), z = view.zoom;
    const hand = times(rotationX(tilt.x * degree), rotationY(tilt.y * degree));
    const distance = heights * Math.max(screen.height, 1);
    const plane = times(turn, [z, 0, 0, 0, -z, 0, -z * view.x, z * view.y, 1]);
    const fromEye = [...hand.slice(0, 6), 0, 0, -distance], projected = times([distance, 0, 0, 0, distance, 0, 0, 0, -1], times(transposed(turned), fromEye));
    const screened = [1, 0, 0, 0, -1, 0, screen.width / 2, screen.height / 2, 1];
    this.toScreenMatrix = times(screened, times(projected, plane));
    this.toPaintingMatrix = inverse(this.toScreenMatrix);
    this.orientation = transposed(times(times(held, hand), turn));
    const {width, height, mm_per_pixel: mm} = picture, eye = applied(this.orientation, [0, 0, distance / z * mm]);
    const fromMiddle = [(view.x - (width - 1) / 2) * mm, (view.y - (height - 1) / 2) * mm];
    this.eye = [eye[0] + fromMiddle[0], eye[1] - fromMiddle[1], eye[2], 1];
  }
  // null where the ray misses the painting's plane.
  toPainting(x, y) {
    const q = applied(this.toPaintingMatrix, [x, y, 1]);
    return q[2] > 0 ? [q[0] / q[2], q[1] / q[2]] : null;
  }
  toScreen(x, y) {
    const q = applied(this.toScreenMatrix, [x, y, 1]);
    return [q[0] / q[2], q[1] / q[2]];
  }
  // The painting's corners on the screen, clockwise; null where one is not before the eye.
  corners() {
    const {width, height} = this.picture, all = [[-0.5, -0.5], [width - 0.5, -0.5], [width - 0.5, height - 0.5], [-0.5, height - 0.5]];
    const seen = all.map(([x, y]) => applied(this.toScreenMatrix, [x, y, 1]));
    return seen.every(q => q[2] > 0) ? seen.map(q => [q[0] / q[2], q[1] / q[2]]) : null;
  }
  inSurface(direction) { return applied(this.orientation, direction); }
  // gl_FragCoord of a picture of width x height pixels that shows the whole screen, its lower left corner at
  // left, bottom -> painting.
  shot(width, height, left = 0, bottom = 0) {
    const x = this.screen.width / width, y = this.screen.height / height;
    const m = times(this.toPaintingMatrix, [x, 0, 0, 0, -y, 0, -x * left, this.screen.height + y * bottom, 1]);
    const scale = Math.abs(m[8]) || 1;
    return m.map(v => v / scale);
  }
  // Smallest rectangle of the painting's pixels that holds all that is seen.
  seen() {
    const {width, height} = this.screen;
    const corners = [[0, 0], [width, 0], [0, height], [width, height]].map(c => this.toPainting(...c));
    const whole = {x0: 0, y0: 0, x1: this.picture.width - 1, y1: this.picture.height - 1};
    if (corners.includes(null)) return whole;
    const xs = corners.map(c => c[0]), ys = corners.map(c => c[1]);
    return {x0: clamp(Math.min(...xs) - 2, 0, whole.x1), y0: clamp(Math.min(...ys) - 2, 0, whole.y1),
            x1: clamp(Math.max(...xs) + 2, 0, whole.x1), y1: clamp(Math.max(...ys) + 2, 0, whole.y1)};
  }
  level(scale) { return clamp(Math.round(Math.log2(Math.max(1, 1 / (scale * this.view.zoom)))), 0, this.picture.levels - 1); }
}

// The whole painting, as large as it can be in one of the rectangles `free` of the screen: {x0, y0, x1, y1}.
export function fitted(picture, screen, turn = 0, free = [{x0: 0, y0: 0, x1: screen.width, y1: screen.height}]) {
  const c = Math.abs(Math.cos(turn * degree)), s = Math.abs(Math.sin(turn * degree));
  const width = c * picture.width + s * picture.height, height = s * picture.width + c * picture.height;
  const zoomIn = r => clamp(fitMargin * Math.min((r.x1 - r.x0) / width, (r.y1 - r.y0) / height), leastZoom, mostZoom);
  const best = free.reduce((a, b) => zoomIn(b) > zoomIn(a) * (1 + 1e-9) ? b : a);
  const view = {x: (picture.width - 1) / 2, y: (picture.height - 1) / 2, zoom: zoomIn(best), turn};
  const aside = unturned(view, (screen.width - best.x0 - best.x1) / 2, (screen.height - best.y0 - best.y1) / 2);
  return {...view, x: view.x + aside[0], y: view.y + aside[1]};
}

// Right and down [pixels of the painting] of a vector on the screen.
export function unturned(view, x, y) {
  const a = view.turn * degree;
  return [(Math.cos(a) * x - Math.sin(a) * y) / view.zoom, (Math.sin(a) * x + Math.cos(a) * y) / view.zoom];
}
// Larger by `factor`; what is at x, y of the screen stays there.
export function zoomed(view, factor, x, y, screen) {
  const before = unturned(view, x - screen.width / 2, y - screen.height / 2);
  const next = {...view, zoom: clamp(view.zoom * factor, leastZoom, mostZoom)};
  const after = unturned(next, x - screen.width / 2, y - screen.height / 2);
  return {...next, x: view.x + before[0] - after[0], y: view.y + before[1] - after[1]};
}
export function panned(picture, view, x, y) {
  const by = unturned(view, x, y);
  return {...view, x: clamp(view.x - by[0], 0, picture.width - 1), y: clamp(view.y - by[1], 0, picture.height - 1)};
}
// Turned by `by` degrees, counter-clockwise, about what is at x, y of the screen.
export function turned(view, by, x, y, screen) {
  const before = unturned(view, x - screen.width / 2, y - screen.height / 2), next = {...view, turn: view.turn + by};
  const after = unturned(next, x - screen.width / 2, y - screen.height / 2);
  return {...next, x: view.x + before[0] - after[0], y: view.y + before[1] - after[1]};
}
// What two fingers do that were at a and b and are at c and d: they keep hold of what is under them.
export function pinched(picture, view, [a, b], [c, d], screen) {
  const distance = (p, q) => Math.max(Math.hypot(q[0] - p[0], q[1] - p[1]), 1), middle = (p, q) => [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2];
  const angle = (p, q) => Math.atan2(q[1] - p[1], q[0] - p[0]) / degree, from = middle(a, b), to = middle(c, d);
  const by = ((angle(a, b) - angle(c, d) + 540) % 360) - 180;
  const moved = panned(picture, view, to[0] - from[0], to[1] - from[1]);
  return turned(zoomed(moved, distance(c, d) / distance(a, b), ...to, screen), by, ...to, screen);
}

// Light: azimuth counter-clockwise from the right, elevation above the painting's plane [degrees], in the room.
export function directionOf({azimuth, elevation}) {
  const a = azimuth * degree, e = elevation * degree;
  return [Math.cos(a) * Math.cos(e), Math.sin(a) * Math.cos(e), Math.sin(e)];
}
// Of a place on the dome seen from above: its rim has radius 1 and is 2 degrees high.
export function lightAt(x, y) {
  const radius = Math.min(Math.hypot(x, y), 1);
  return {azimuth: radius > 0 ? Math.atan2(y, x) / degree : 0, elevation: Math.max(Math.acos(radius) / degree, lowestLight)};
}
