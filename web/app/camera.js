// camera.js: the room as a camera sees it (thesis 5.2.2, 5.3.3): the brightest part of it as light, and its picture behind the
// painting. Light is looked for in 32 x 24 pixels of pictures as they come, which are kept nowhere.

import {applied} from './shared/placement.js';

const columns = 32, rows = 24, everyMs = 120;
const fieldOfView = 66;  // [degrees] along the longer side of the picture, of most cameras of tablets; browsers do not tell it

// Direction in the screen's frame (x right, y up, z towards the viewer) of the mean of the brightest hundredth, of RGBA pixels of
// a camera that looks the way the screen does, and so sees the screen's right at its left, or away. Null where the room is evenly
// lit.
export function brightest(pixels, {width = columns, height = rows, across = fieldOfView, away = false} = {}) {
  const light = Array.from({length: width * height}, (_, i) => 0.2126 * pixels[4 * i] + 0.7152 * pixels[4 * i + 1] + 0.0722 * pixels[4 * i + 2]);
  const sorted = [...light].sort((a, b) => b - a), limit = sorted[Math.ceil(light.length / 100) - 1], middle = sorted[light.length >> 1];
  if (limit < 1.25 * middle + 8) return null;
  let x = 0, y = 0, sum = 0;
  light.forEach((value, i) => {
    if (value < limit) return;
    x += value * (i % width + 0.5 - width / 2);
    y += value * (height / 2 - Math.floor(i / width) - 0.5);
    sum += value;
  });
  const scale = 2 * Math.tan(across / 2 * Math.PI / 180) / width, direction = [(away ? x : -x) / sum * scale, y / sum * scale, away ? -1 : 1], length = Math.hypot(...direction);
  return direction.map(v => v / length);
}
export const lightOf = ([x, y, z]) => ({azimuth: Math.atan2(y, x) * 180 / Math.PI, elevation: Math.max(Math.asin(z) * 180 / Math.PI, 2)});

// How far before a screen the eye is, in its heights, to which a camera's picture that fills it looks as the room does.
export function cameraEye({videoWidth, videoHeight}, {width, height}) {
  const focal = Math.max(videoWidth, videoHeight) / 2 / Math.tan(fieldOfView / 2 * Math.PI / 180);
  return focal * Math.max(width / videoWidth, height / videoHeight) / height;
}

export class RoomLight {
  // video: an element that shows what the camera sees; held(): how the screen is held (held.js), or null; found(direction), as the
  // light comes over the painting, with each picture in which a light is.
  constructor(video, held, found) { Object.assign(this, {video, held, found, stream: null, away: false}); }
  get runs() { return this.stream !== null; }
  // Whether the camera looks at the painter, or away, at the room behind the painting. Words where it cannot be; nothing where it
  // runs.
  async start(away) {
    this.stop();
    if (!navigator.mediaDevices?.getUserMedia) return 'Browsers give the camera only to pages from https:// or localhost.';
    const size = away ? {width: 1280, height: 720} : {width: 320, height: 240};
    try {
      this.stream = await navigator.mediaDevices.getUserMedia({video: {facingMode: away ? 'environment' : 'user', ...size}, audio: false});
    } catch (error) {
      return error.name === 'NotFoundError' ? 'This device has no camera.' : 'The camera is not allowed for this page: allow it in the browser’s settings, or set the light by hand.';
    }
    const {video} = this, canvas = Object.assign(document.createElement('canvas'), {width: columns, height: rows}), context = canvas.getContext('2d', {willReadFrequently: true});
    Object.assign(video, {srcObject: this.stream, muted: true, playsInline: true, hidden: !away});
    Object.assign(this, {away, direction: null});
    await video.play();
    this.timer = setInterval(() => {
      context.drawImage(video, 0, 0, columns, rows);
      const direction = brightest(context.getImageData(0, 0, columns, rows).data, {away});
      if (direction) this.take(direction);
    }, everyMs);
    return '';
  }
  // Comes over gently: a hand that passes by does not flash.
  take(direction) {
    const held = this.held(), [x, y, z] = held ? applied(held, direction) : direction;
    // A camera that looks away sees only what is behind the painting, and that would not light it: it does from before it.
    const next = [x, y, this.away ? Math.abs(z) : z];
    this.direction = this.direction ? this.direction.map((v, i) => v + 0.25 * (next[i] - v)) : next;
    this.found(this.direction);
  }
  stop() {
    clearInterval(this.timer);
    for (const track of this.stream?.getTracks() ?? []) track.stop();
    Object.assign(this.video, {srcObject: null, hidden: true});
    Object.assign(this, {stream: null, away: false});
    return '';
  }
}
