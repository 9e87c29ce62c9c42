// held.js: how the screen is held in the room, from the device's orientation sensor: thesis eq. 3.10 to 3.13, with the turn of
// the screen undone, smoothed by the filter of viewer/devices/one_euro.h.

import {degree, rotationX, rotationY, rotationZ, times, transposed} from './placement.js';

// Casiez, Roussel, Vogel 2012, "1 Euro filter", of lists of numbers. restingHz: the cut-off of what rests; perSpeed: how much it
// grows with the speed [Hz for one unit a second].
export class OneEuro {
  constructor(restingHz, perSpeed) { Object.assign(this, {restingHz, perSpeed, time: null}); }
  static weight(cutoff, seconds) {
    const turns = 2 * Math.PI * cutoff * seconds;
    return turns / (turns + 1);
  }
  filtered(values, time) {
    const seconds = time - this.time;
    if (this.time === null) {
      Object.assign(this, {last: values, value: values, speed: values.map(() => 0)});
    } else if (seconds > 0) {
      const quick = OneEuro.weight(1, seconds);
      this.speed = this.speed.map((v, i) => v + quick * ((values[i] - this.last[i]) / seconds - v));
      const weight = OneEuro.weight(this.restingHz + this.perSpeed * Math.hypot(...this.speed), seconds);
      this.value = this.value.map((v, i) => v + weight * (values[i] - v));
      this.last = values;
    }
    this.time = time;
    return this.value;
  }
}

// Device (x right, y up, z out of its screen, as it is held upright) -> earth (x east, y north, z up), of an event of the sensor
// (W3C: intrinsic turns about z, x and y).
export function earthFromDevice({alpha, beta, gamma}) {
  return times(times(rotationZ(alpha * degree), rotationX(beta * degree)), rotationY(gamma * degree));
}

// Unit quaternion [w, x, y, z] of a rotation, and back. The largest component is taken from its square (Shepperd 1978).
export function quaternionOf(m) {
  const trace = m[0] + m[4] + m[8], squares = [trace, m[0], m[4], m[8]], largest = squares.indexOf(Math.max(...squares));
  const q = [
    [1 + trace, m[5] - m[7], m[6] - m[2], m[1] - m[3]],
    [m[5] - m[7], 1 + m[0] - m[4] - m[8], m[1] + m[3], m[6] + m[2]],
    [m[6] - m[2], m[1] + m[3], 1 - m[0] + m[4] - m[8], m[5] + m[7]],
    [m[1] - m[3], m[6] + m[2], m[5] + m[7], 1 - m[0] - m[4] + m[8]],
  ][largest];
  const length = Math.hypot(...q);
  return q.map(v => v / length);
}
export function rotationOf(quaternion) {
  const length = Math.hypot(...quaternion), [w, x, y, z] = quaternion.map(v => v / length);
  return [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y), 2 * (x * y - w * z), 1 - 2 * (x * x + z * z),
    2 * (y * z + w * x), 2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)];
}

const restingHz = 1.2, perSpeed = 6, patience = 1500;

// What a person should know where HeldScreen.start() promises anything but 'runs'.
export const tiltRefusals = {
  denied: 'The tilt is switched off for this page. Allow “motion and orientation” for it in the browser’s settings, or drag to tilt.',
  none: 'This device has no tilt sensor that the browser can read. Drag to tilt the painting instead.',
  insecure: 'Browsers read the tilt only on secure pages and on localhost. Open this one over a secure connection, or drag to tilt.',
};

export class HeldScreen {
  // changed() after every move; `matrix`: the screen now -> the screen as it was when it was level.
  constructor(changed) {
    this.changed = changed;
    this.matrix = null;
    this.follow = event => this.take(event);
    this.turned = () => { if (this.last) this.show(); };
  }
  get runs() { return this.matrix !== null; }

  // Promises 'runs', 'denied', 'none' (no sensor, or it says nothing) or 'insecure' (browsers give it to secure pages and
  // localhost alone). To be called from a click: iOS asks only then.
  async start() {
    if (!window.isSecureContext) return 'insecure';
    if (typeof DeviceOrientationEvent === 'undefined') return 'none';
    if (DeviceOrientationEvent.requestPermission) {
      const answer = await DeviceOrientationEvent.requestPermission().catch(() => 'denied');
      if (answer !== 'granted') return 'denied';
    }
    this.stop();
    const begun = new Promise(resolve => { this.begun = resolve; });
    window.addEventListener('deviceorientation', this.follow);
    window.screen.orientation?.addEventListener('change', this.turned);
    const answer = await Promise.race([begun, new Promise(resolve => setTimeout(resolve, patience, 'none'))]);
    if (answer === 'none') this.stop();
    return answer;
  }
  stop() {
    window.removeEventListener('deviceorientation', this.follow);
    window.screen.orientation?.removeEventListener('change', this.turned);
    Object.assign(this, {matrix: null, level: null, filter: new OneEuro(restingHz, perSpeed), last: null});
  }
  // As it is held now, it is level.
  setLevel() {
    if (!this.last) return;
    this.level = rotationOf(this.last);
    this.show();
  }

  take(event) {
    if (event.alpha === null && event.beta === null) return;
    let q = quaternionOf(earthFromDevice({alpha: event.alpha ?? 0, beta: event.beta ?? 0, gamma: event.gamma ?? 0}));
    // q and -q are the same turn: the one that is nearer.
    if (this.last && q.reduce((sum, v, i) => sum + v * this.last[i], 0) < 0) q = q.map(v => -v);
    this.last = this.filter.filtered(q, performance.now() / 1000);
    this.level ??= rotationOf(this.last);
    this.begun?.('runs');
    this.show();
  }
  // The device's turn in the frame of what the screen shows, which the browser has turned on the device [degrees]. So a turn of
  // that is none of the painting, and is not smoothed.
  show() {
    const shown = rotationZ(-(window.screen.orientation?.angle ?? window.orientation ?? 0) * degree);
    this.matrix = times(transposed(times(this.level, shown)), times(rotationOf(this.last), shown));
    this.changed();
  }
}
