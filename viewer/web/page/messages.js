// messages.js: a page around this one, or one that opened it, asks and tells it by postMessage (docs/guide/web-export.md).
//
// Only pages of the same origin are heard, and those of the origins that it was exported for; answers go to the one that asked.

import {followWords, wordsOf} from './link.js';

const messageVersion = 1;

// What is shown, as messages say it.
export function toldOf(state, data) {
  const {azimuth, elevation} = state.light, {x, y, zoom, turn} = state.view, several = data.states.length > 1;
  return {
    light: {azimuth, elevation, colour: state.colour, softness: state.softness}, view: {x, y, zoom, turn}, tilt: {x: state.tilt.x, y: state.tilt.y},
    look: data.looks[state.look].name, shadows: state.shadows, exposure: state.exposure, annotation: state.selected,
    layers: {left: data.states[state.left].name, right: state.curtain ? data.states[state.right].name : null, divider: several ? state.divider : null},
    hash: wordsOf(state, data).toString(),
  };
}

// A number of a list's entry that is called by its name or number.
function entry(names, asked, what) {
  const found = Number.isInteger(asked) ? asked : names.indexOf(asked);
  if (!(found >= 0 && found < names.length)) throw new Error(`${what} ${JSON.stringify(asked)} is none of ${names.map(n => `"${n}"`).join(', ')}`);
  return found;
}

// The words of a link that a message says.
function wordsIn({light = {}, view = {}, tilt = {}, look, shadows, exposure, layers = {}, hash}, data) {
  const words = new URLSearchParams(String(hash ?? '').replace(/^#/, ''));
  const numbers = {azimuth: light.azimuth, elevation: light.elevation, softness: light.softness, x: view.x, y: view.y, zoom: view.zoom, turn: view.turn,
    tilt_x: tilt.x, tilt_y: tilt.y, exposure, divider: layers.divider ?? undefined};
  for (const [name, value] of Object.entries(numbers)) {
    if (value === undefined) continue;
    if (!Number.isFinite(value)) throw new Error(`${name} ${JSON.stringify(value)} is no number`);
    words.set(name, value);
  }
  if (light.colour !== undefined && !/^#[0-9a-f]{6}$/i.test(light.colour)) throw new Error(`light.colour ${JSON.stringify(light.colour)} is no colour like "#ffcc88"`);
  if (light.colour !== undefined) words.set('colour', light.colour);
  if (shadows !== undefined) words.set('shadows', +Boolean(shadows));
  if (look !== undefined) words.set('look', entry(data.looks.map(l => l.name), look, 'look'));
  const names = data.states.map(s => s.name);
  if (layers.left !== undefined) words.set('left', entry(names, layers.left, 'layers.left'));
  if (layers.right !== undefined) words.set('curtain', +(layers.right !== null));
  if (layers.right !== undefined && layers.right !== null) words.set('right', entry(names, layers.right, 'layers.right'));
  return words;
}

// page: state, data, notes, select(id), ask(), snapshot().
export function handlersOf({state, data, notes, select, ask, snapshot}) {
  const {width, height, title, mm_per_pixel, scale_known} = data;
  const told = () => ({...toldOf(state, data), picture: {width, height, title, mm_per_pixel: scale_known ? mm_per_pixel : null},
    looks: data.looks.map(l => l.name), states: data.states.map(s => s.name)});
  return {
    get: told,
    set: message => {
      followWords(wordsIn(message, data), state, data);
      if (message.annotation !== undefined) select(message.annotation);
      ask();
      return told();
    },
    annotations: ({annotations}) => {
      if (annotations !== undefined) notes.replace(annotations);
      return {annotations: notes.page()};
    },
    snapshot: async () => ({png: await snapshot()}),
  };
}

export class Messages {
  // origins: of --embed-origin, "*" for all. handlers: name -> what a message is answered with, or a promise of it; throws Error.
  constructor(origins, handlers) {
    Object.assign(this, {origins, handlers, listeners: new Map(), heard: Promise.resolve()});
    // One after another: a picture is of what was set before it was asked for.
    window.addEventListener('message', event => { this.heard = this.heard.then(() => this.hear(event)).catch(console.error); });
    for (const page of [window.parent, window.opener])
      if (page && page !== window) for (const origin of this.greeted()) page.postMessage({tangipaint: 'ready', version: messageVersion}, origin);
  }
  // A page from a disk has no origin: it is "null" to others, and can only be told without one.
  trusts(origin) { return this.origins.includes('*') || this.origins.includes(origin) || origin === window.origin && (origin !== 'null' || location.protocol === 'file:'); }
  greeted() { return this.origins.length ? this.origins : [window.origin === 'null' ? '*' : window.origin]; }
  answer(source, origin, words) { source.postMessage(words, origin === 'null' ? '*' : origin); }

  async hear({data, origin, source}) {
    const asked = data?.tangipaint;
    if (typeof asked !== 'string' || !source || source === window || !this.trusts(origin)) return;
    const reply = words => this.answer(source, origin, {...words, ...data.id === undefined ? {} : {id: data.id}});
    try {
      if (asked === 'listen') this.listeners.set(source, origin);
      else if (asked === 'unlisten') this.listeners.delete(source);
      else if (!Object.hasOwn(this.handlers, asked)) throw new Error(`"${asked}" is none of ${Object.keys(this.handlers).join(', ')}, listen, unlisten`);
      const result = await (this.handlers[asked] ?? this.handlers.get)(data);
      reply({tangipaint: 'answer', to: asked, ...result});
    } catch (error) {
      reply({tangipaint: 'error', to: asked, message: error.message});
    }
  }
  // To all who listen; those that are gone are forgotten.
  tell(event, words) {
    for (const [source, origin] of this.listeners) {
      if (source.closed) this.listeners.delete(source);
      else this.answer(source, origin, {tangipaint: event, ...words});
    }
  }
}
