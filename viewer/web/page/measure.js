// measure.js: heights along a line, as viewer/model/measurement.cpp has them, and their plot.

import {clamp} from './placement.js';
import {tileSide} from './tiles.js';

const tilesKept = 64;

// Heights of a state's pixels, of the tiles that they were asked for: a few of these are kept.
export class Heights {
  // picture: width, height, fields, range (viewer/web/web_data.h); fetch: as Tiles has it.
  constructor(picture, fetch) { Object.assign(this, {picture, fetch, tiles: new Map()}); }
  tile(column, row) {
    const name = `0/${column}_${row}`, found = this.tiles.get(name);
    this.tiles.delete(name);  // and back as the last that was asked for
    const asked = found ?? this.load(name, column, row);
    this.tiles.set(name, asked);
    if (this.tiles.size > tilesKept) this.tiles.delete(this.tiles.keys().next().value);
    return asked;
  }
  async load(name, column, row) {
    const {picture} = this, width = Math.min(tileSide, picture.width - column * tileSide), height = Math.min(tileSide, picture.height - row * tileSide);
    try {
      const texels = await this.fetch({name}, width, height), {word, shift, bits} = picture.fields.at(-1), most = 2 ** bits - 1;
      const values = Float32Array.from({length: width * height}, (_, i) => picture.range[2] + (texels[4 * i + word] >>> shift & most) / most * picture.range[3]);
      return {width, values};
    } catch (error) {
      this.tiles.delete(name);
      throw error;
    }
  }
  // Of a pixel, or of the nearest one there is.
  async at(x, y) {
    const column = clamp(x, 0, this.picture.width - 1), row = clamp(y, 0, this.picture.height - 1);
    const tile = await this.tile(Math.floor(column / tileSide), Math.floor(row / tileSide));
    return tile.values[row % tileSide * tile.width + column % tileSide];
  }
  async bilinear(x, y) {
    const x0 = Math.floor(x), y0 = Math.floor(y), u = x - x0, v = y - y0;
    const [a, b, c, d] = await Promise.all([[0, 0], [1, 0], [0, 1], [1, 1]].map(([i, j]) => this.at(x0 + i, y0 + j)));
    return (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * c + u * d);
  }
}

// Which part of a line, from + t (to - from), lies between `low` and `high` in one coordinate.
function clipped(from, to, low, high, [begin, end]) {
  if (from === to) return from < low || from > high ? [begin, -1] : [begin, end];
  const a = (low - from) / (to - from), b = (high - from) / (to - from);
  return [Math.max(begin, Math.min(a, b)), Math.min(end, Math.max(a, b))];
}

// {step, heights} [mm, or pixels where the scale is unknown] at even steps of at most a pixel; null beside the painting.
export async function heightProfile(heights, [from, to]) {
  const {width, height, mm_per_pixel: mm} = heights.picture;
  const [begin, end] = clipped(from[1], to[1], -0.5, height - 0.5, clipped(from[0], to[0], -0.5, width - 0.5, [0, 1]));
  const place = t => [from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1])];
  const [a, b] = [place(begin), place(end)], length = Math.hypot(b[0] - a[0], b[1] - a[1]);
  if (!(end > begin) || length === 0) return null;
  const steps = Math.max(1, Math.ceil(length)), values = new Float32Array(steps + 1);
  for (let first = 0; first <= steps; first += 256) {  // so that few tiles are asked for at once
    const places = Array.from({length: Math.min(256, steps + 1 - first)}, (_, i) => first + i);
    const some = await Promise.all(places.map(i => heights.bilinear(a[0] + (b[0] - a[0]) * i / steps, a[1] + (b[1] - a[1]) * i / steps)));
    values.set(some, first);
  }
  return {step: length / steps * mm, heights: values};
}

// Its length as the line lies in the plane, and as it lies on the relief; the lowest and highest point.
export function figuresOf({step, heights}) {
  let over = 0, low = Infinity, high = -Infinity;
  heights.forEach((h, i) => {
    if (i > 0) over += Math.hypot(step, h - heights[i - 1]);
    low = Math.min(low, h);
    high = Math.max(high, h);
  });
  return {length: step * (heights.length - 1), over, low, high};
}

// "distance_mm,height_mm" and a line for each height, a column for each state.
export function csvOf(profiles, names, unit) {
  const short = value => String(+value.toPrecision(6)), head = names.length > 1 ? names.map(n => `height_${unit} ${n.replace(/[",\n]/g, ' ')}`) : [`height_${unit}`];
  const rows = Array.from(profiles[0].heights, (_, i) => [i * profiles[0].step, ...profiles.map(p => p.heights[i])].map(short).join(','));
  return `${[`distance_${unit}`, ...head].join(',')}\n${rows.join('\n')}\n`;
}

// Path of a profile in a plot of width x height: lowest below, highest above.
function plotted({heights}, width, height, low, high) {
  const y = h => ((high - h) / Math.max(high - low, 1e-6) * height).toFixed(2), every = Math.max(1, Math.floor(heights.length / (2 * width)));
  let path = '';
  heights.forEach((h, i) => { if (i % every === 0 || i === heights.length - 1) path += `${path ? 'L' : 'M'}${(i / (heights.length - 1) * width).toFixed(2)} ${y(h)}`; });
  return path;
}

// The pane of the profile: words, plot, and the numbers to be copied.
export class ProfilePane {
  // pane: <section id="profile">; states: States; told(text): words for all to see.
  constructor(pane, states, told) {
    Object.assign(this, {pane, states, told, heights: states.data.states.map(() => null), line: '', profiles: []});
    this.unit = states.data.scale_known ? 'mm' : 'px';
    this.within('.copy').onclick = () => this.copy();
  }
  within(selector) { return this.pane.querySelector(selector); }
  close() {
    this.pane.hidden = true;
    this.line = '';
  }
  // The heights along a line of these states. What was asked for later wins.
  async show(line, shown) {
    const asked = JSON.stringify([line, shown]);
    if (asked === this.line) return;
    this.line = asked;
    this.pane.hidden = false;
    this.within('.figures').textContent = 'Heights are being fetched …';
    try {
      const profiles = await Promise.all(shown.map(k => heightProfile(this.heights[k] ??= new Heights(this.states.picture(k), this.states.fetch(k)), line)));
      if (asked === this.line) this.draw(profiles.filter(Boolean), shown.map(k => this.states.data.states[k].name));
    } catch (error) {
      if (asked !== this.line) return;
      this.line = '';
      this.within('.figures').textContent = `The heights could not be loaded: ${error.message}. Draw the line again.`;
    }
  }
  draw(profiles, names) {
    Object.assign(this, {profiles, names});
    this.within('.copy').disabled = this.within('.plot').hidden = !profiles.length;
    if (!profiles.length) {
      this.within('.figures').textContent = 'This line does not lie on the painting.';
      return;
    }
    const {unit} = this, figures = profiles.map(figuresOf), low = Math.min(...figures.map(f => f.low)), high = Math.max(...figures.map(f => f.high));
    const words = ({length, over, low: l, high: h}) => `${length.toFixed(2)} ${unit} long, ${over.toFixed(2)} ${unit} over the relief, heights from ${l.toFixed(3)} to ${h.toFixed(3)} ${unit}`;
    const {lossy} = this.states.data, doubt = lossy ? `\nThe heights of this page are ± ${lossy.height_rms.toPrecision(2)} ${unit} (rms).` : '';
    this.within('.figures').textContent = figures.map((f, i) => (names.length > 1 ? `${names[i]}: ` : '') + words(f)).join('\n') + doubt;
    this.within('.plot').setAttribute('aria-label', `Height along the line, ${this.within('.figures').textContent}`);
    const paths = this.pane.querySelectorAll('.plot path');
    paths.forEach((path, i) => path.setAttribute('d', profiles[i] ? plotted(profiles[i], 280, 90, low, high) : ''));
    this.within('.high').textContent = `${high.toFixed(3)} ${unit}`;
    this.within('.low').textContent = `${low.toFixed(3)} ${unit}`;
    this.within('.end').textContent = `${figures[0].length.toFixed(2)} ${unit}`;
  }
  async copy() {
    const text = csvOf(this.profiles, this.names, this.unit);
    const copied = await (navigator.clipboard?.writeText(text).then(() => true, () => false) ?? false);
    this.told(copied ? 'The heights have been copied as CSV.' : 'This browser lets no page copy here; the heights are saved as a file.');
    if (!copied) saveAs(new Blob([text], {type: 'text/csv'}), 'heights.csv');
  }
}

// Hands a file to who looks at the page.
export function saveAs(blob, name) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
