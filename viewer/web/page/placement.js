// placement.js: where the painting lies in space, and the light: as viewer/render/view.cpp and tilt.cpp have it.
// Matrices are 3 x 3, column by column. Screen: device pixels from its upper left corner. Painting: pixels, whole
// numbers are centres.
const degree = Math.PI / 180, eyeHeights = 3, fitMargin = 0.95, lowestLight = 2, mostTilt = 75, leastZoom = 1 / 1024, mostZoom = 64;
const clamp = (v, low, high) => Math.min(Math.max(v, low), high);

function times(a, b) {
  const m = [];
  for (let c = 0; c < 3; ++c)
    for (let r = 0; r < 3; ++r) m.push(a[r] * b[3 * c] + a[3 + r] * b[3 * c + 1] + a[6 + r] * b[3 * c + 2]);
  return m;
}
const applied = (m, v) => [0, 1, 2].map(r => m[r] * v[0] + m[3 + r] * v[1] + m[6 + r] * v[2]);
const transposed = m => [m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]];
function inverse(m) {
  const cross = (i, j) => [m[i + 1] * m[j + 2] - m[i + 2] * m[j + 1], m[i + 2] * m[j] - m[i] * m[j + 2], m[i] * m[j + 1] - m[i + 1] * m[j]];
  const rows = [cross(3, 6), cross(6, 0), cross(0, 3)];
  const determinant = m[0] * rows[0][0] + m[1] * rows[0][1] + m[2] * rows[0][2];
  return transposed(rows.flat().map(v => v / determinant));
}
const rotationX = a => [1, 0, 0, 0, Math.cos(a), Math.sin(a), 0, -Math.sin(a), Math.cos(a)];
const rotationY = a => [Math.cos(a), 0, -Math.sin(a), 0, 1, 0, Math.sin(a), 0, Math.cos(a)];
const rotationZ = a => [Math.cos(a), Math.sin(a), 0, -Math.sin(a), Math.cos(a), 0, 0, 0, 1];

// view: x, y [pixels of the painting] at the middle of the screen, zoom, turn [degrees]. tilt: x, y [degrees].
class Placement {
  constructor(view, tilt, screen) {
    this.view = view;
    this.screen = screen;
    const turn = rotationZ(view.turn * degree), z = view.zoom;
    const hand = times(rotationX(tilt.x * degree), rotationY(tilt.y * degree));
    const distance = eyeHeights * Math.max(screen.height, 1);
    const plane = times(turn, [z, 0, 0, 0, -z, 0, -z * view.x, z * view.y, 1]);
    const projected = [distance * hand[0], distance * hand[1], -hand[2], distance * hand[3], distance * hand[4], -hand[5], 0, 0, distance];
    const screened = [1, 0, 0, 0, -1, 0, screen.width / 2, screen.height / 2, 1];
    this.toScreenMatrix = times(screened, times(projected, plane));
    this.toPaintingMatrix = inverse(this.toScreenMatrix);
    this.orientation = transposed(times(hand, turn));
    const eye = applied(this.orientation, [0, 0, distance / z * data.mm_per_pixel]);
    const fromMiddle = [(view.x - (data.width - 1) / 2) * data.mm_per_pixel, (view.y - (data.height - 1) / 2) * data.mm_per_pixel];
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
    const whole = {x0: 0, y0: 0, x1: data.width - 1, y1: data.height - 1};
    if (corners.includes(null)) return whole;
    const xs = corners.map(c => c[0]), ys = corners.map(c => c[1]);
    return {x0: clamp(Math.min(...xs) - 2, 0, whole.x1), y0: clamp(Math.min(...ys) - 2, 0, whole.y1),
            x1: clamp(Math.max(...xs) + 2, 0, whole.x1), y1: clamp(Math.max(...ys) + 2, 0, whole.y1)};
  }
  level(scale) { return clamp(Math.round(Math.log2(Math.max(1, 1 / (scale * this.view.zoom)))), 0, data.levels - 1); }
}

// The whole painting, as large as it can be in one of the rectangles `free` of the screen: {x0, y0, x1, y1}.
function fitted(screen, turn = 0, free = [{x0: 0, y0: 0, x1: screen.width, y1: screen.height}]) {
  const c = Math.abs(Math.cos(turn * degree)), s = Math.abs(Math.sin(turn * degree));
  const width = c * data.width + s * data.height, height = s * data.width + c * data.height;
  const zoomIn = r => clamp(fitMargin * Math.min((r.x1 - r.x0) / width, (r.y1 - r.y0) / height), leastZoom, mostZoom);
  const best = free.reduce((a, b) => zoomIn(b) > zoomIn(a) * (1 + 1e-9) ? b : a);
  const view = {x: (data.width - 1) / 2, y: (data.height - 1) / 2, zoom: zoomIn(best), turn};
  const aside = unturned(view, (screen.width - best.x0 - best.x1) / 2, (screen.height - best.y0 - best.y1) / 2);
  return {...view, x: view.x + aside[0], y: view.y + aside[1]};
}

// Right and down [pixels of the painting] of a vector on the screen.
function unturned(view, x, y) {
  const a = view.turn * degree;
  return [(Math.cos(a) * x - Math.sin(a) * y) / view.zoom, (Math.sin(a) * x + Math.cos(a) * y) / view.zoom];
}
// Larger by `factor`; what is at x, y of the screen stays there.
function zoomed(view, factor, x, y, screen) {
  const before = unturned(view, x - screen.width / 2, y - screen.height / 2);
  const next = {...view, zoom: clamp(view.zoom * factor, leastZoom, mostZoom)};
  const after = unturned(next, x - screen.width / 2, y - screen.height / 2);
  return {...next, x: view.x + before[0] - after[0], y: view.y + before[1] - after[1]};
}
function panned(view, x, y) {
  const by = unturned(view, x, y);
  return {...view, x: clamp(view.x - by[0], 0, data.width - 1), y: clamp(view.y - by[1], 0, data.height - 1)};
}

// Light: azimuth counter-clockwise from the right, elevation above the painting's plane [degrees], in the room.
function directionOf({azimuth, elevation}) {
  const a = azimuth * degree, e = elevation * degree;
  return [Math.cos(a) * Math.cos(e), Math.sin(a) * Math.cos(e), Math.sin(e)];
}
// Of a place on the dome seen from above: its rim has radius 1 and is 2 degrees high.
function lightAt(x, y) {
  const radius = Math.min(Math.hypot(x, y), 1);
  return {azimuth: radius > 0 ? Math.atan2(y, x) / degree : 0, elevation: Math.max(Math.acos(radius) / degree, lowestLight)};
}
