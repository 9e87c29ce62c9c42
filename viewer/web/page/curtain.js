// curtain.js: two states of a painting left and right of a divider, which a hand or keys move.

import {clamp} from './placement.js';

export class Curtain {
  // slider: <div id="curtain" role="slider">; data: of the page; state: left, right, divider, curtain; changed() after each change.
  constructor(slider, data, state, changed) {
    Object.assign(this, {slider, data, state, changed});
    slider.addEventListener('pointerdown', event => { slider.setPointerCapture(event.pointerId); });
    slider.addEventListener('pointermove', event => { if (slider.hasPointerCapture(event.pointerId)) this.to(event.clientX); });
    slider.addEventListener('keydown', event => this.key(event));
  }
  // The states that are seen, the left one first.
  get shown() { return this.state.curtain ? [this.state.left, this.state.right] : [this.state.left]; }
  to(x) {
    const box = this.slider.parentElement.getBoundingClientRect();
    this.move((x - box.left) / box.width);
  }
  move(divider) {
    this.state.divider = clamp(divider, 0, 1);
    this.changed();
  }
  key(event) {
    const {divider} = this.state, step = {ArrowLeft: -0.02, ArrowDown: -0.02, ArrowRight: 0.02, ArrowUp: 0.02, PageDown: -0.1, PageUp: 0.1}[event.key];
    const to = event.key === 'Home' ? 0 : event.key === 'End' ? 1 : step === undefined ? null : divider + step;
    if (to === null || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation();
    this.move(to);
  }
  // The parts of a canvas of this size that the states are seen in.
  parts({width, height}) {
    if (!this.state.curtain) return [{left: 0, bottom: 0, width, height}];
    const middle = Math.round(this.state.divider * width);
    return [{left: 0, bottom: 0, width: middle, height}, {left: middle, bottom: 0, width: width - middle, height}];
  }
  // Places the divider, and says what it divides.
  draw() {
    const {slider, state, data} = this, [left, right] = [state.left, state.right].map(k => data.states[k].name);
    slider.hidden = !state.curtain;
    slider.style.left = `${100 * state.divider}%`;
    slider.setAttribute('aria-valuenow', Math.round(100 * state.divider));
    slider.setAttribute('aria-valuetext', `${left} on the left ${Math.round(100 * state.divider)} %, ${right} on the right`);
    slider.querySelector('.before').textContent = left;
    slider.querySelector('.after').textContent = right;
  }
}
