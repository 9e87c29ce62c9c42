// link.js: what is shown, as words: of a link to a view, of an annotation that keeps its view, and of messages.

import {clamp, leastZoom, lowestLight, mostTilt, mostZoom} from './placement.js';
import {still} from './moves.js';

export const toolWords = ['light', 'tilt', 'pan', 'ruler', 'point', 'line', 'polygon', 'text'];
export const mostSoftness = 15;  // [degrees], as in the window

const within = (low, high) => value => clamp(value, low, high), around = value => value - 360 * Math.ceil((value - 180) / 360);
const oneOf = count => value => clamp(Math.round(value), 0, count - 1);

// Of each number: where it is in the state, and what of any number can be shown, as the hand would reach it.
const numbersOf = data => ({
  azimuth: ['light', 'azimuth', around], elevation: ['light', 'elevation', within(lowestLight, 90)],
  tilt_x: ['tilt', 'x', within(-mostTilt, mostTilt)], tilt_y: ['tilt', 'y', within(-mostTilt, mostTilt)],
  x: ['view', 'x', within(0, data.width - 1)], y: ['view', 'y', within(0, data.height - 1)], zoom: ['view', 'zoom', within(leastZoom, mostZoom)],
  turn: ['view', 'turn', around], look: ['look', '', oneOf(data.looks.length)], softness: ['softness', '', within(0, mostSoftness)],
  exposure: ['exposure', '', within(-3, 3)], ambient: ['ambient', '', within(0, 1)], shoulder: ['shoulder', '', within(0, 1)],
  left: ['left', '', oneOf(data.states.length)], right: ['right', '', oneOf(data.states.length)], divider: ['divider', '', within(0, 1)],
});

// Takes the words of a link (URLSearchParams) into a state; what is none of ours, or no number, is left alone. True where they
// say what part of the painting to show.
export function followWords(words, state, data) {
  for (const [name, [key, inner, shown]] of Object.entries(numbersOf(data))) {
    const word = (words.get(name) ?? '').trim().replace(',', '.'), value = Number(word);
    if (!word || !Number.isFinite(value)) continue;
    if (inner) state[key] = {...state[key], [inner]: shown(value)};
    else state[key] = shown(value);
    if (key === 'light') state.sweeping = false;
    if (key === 'tilt') state.tilt = {...still, x: state.tilt.x, y: state.tilt.y};
  }
  const colour = words.get('colour') ?? '';
  if (/^#?[0-9a-f]{6}$/i.test(colour)) state.colour = `#${colour.slice(-6).toLowerCase()}`;
  for (const key of ['shadows', 'curtain', 'ui']) if (words.has(key)) state[key] = words.get(key) !== '0';
  if (data.states.length < 2) state.curtain = false;
  if (toolWords.includes(words.get('tool'))) state.tool = words.get('tool');
  return words.has('zoom');
}

// The words that show it again.
export function wordsOf(state, data) {
  const numbers = Object.entries(numbersOf(data)).map(([name, [key, inner]]) => [name, +(inner ? state[key][inner] : state[key]).toFixed(4)]);
  const several = data.states.length > 1 ? [['curtain', +state.curtain]] : [];
  const own = numbers.filter(([name]) => several.length || !['left', 'right', 'divider'].includes(name));
  return new URLSearchParams([...own, ...several, ['colour', state.colour.slice(1)], ['shadows', +state.shadows]]);
}
