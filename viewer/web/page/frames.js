// frames.js: a frame when something has changed; coarser while it moves on a slow machine, and fine once it rests.

import {clamp} from './placement.js';

const restsAfter = 150, coarsest = 0.25;  // [ms], [1]

export class Frames {
  // on: {advance(seconds): true while something goes on by itself, moving(): true while a hand moves it, draw(moving, scale)}.
  constructor(on) { Object.assign(this, {on, scale: 1, wanted: false, moved: false, last: 0}); }
  ask() {
    clearTimeout(this.rest);
    if (this.wanted || this.stopped) return;
    this.wanted = true;
    requestAnimationFrame(now => this.frame(now));
  }
  stop() {
    this.stopped = true;
    clearTimeout(this.rest);
  }
  frame(now) {
    if (this.stopped) return;
    const seconds = Math.min((now - this.last) / 1000, 0.1), follows = now - this.last < 100;
    if (this.moved && follows) this.scale = clamp(seconds > 0.025 ? this.scale * 0.85 : seconds < 0.018 ? this.scale * 1.05 : this.scale, coarsest, 1);
    this.last = now;
    this.wanted = false;
    const goesOn = this.on.advance(seconds), moving = goesOn || this.on.moving();
    this.on.draw(moving, moving ? this.scale : 1);
    this.moved = moving;
    if (goesOn) this.ask();
    else if (moving) this.rest = setTimeout(() => this.ask(), restsAfter);
  }
}
