// page.js: the page: controls, what is drawn when, links to a view.

import {sceneOf, usualSoftness} from './drawing.js';
import {Curtain} from './curtain.js';
import {Frames} from './frames.js';
import {InputController} from './hand.js';
import {HeldScreen, tiltRefusals} from './held.js';
import {followWords, mostSoftness, toolWords, wordsOf} from './link.js';
import {MarkPen} from './mark_pen.js';
import {Marks} from './marks.js';
import {ProfilePane, saveAs} from './measure.js';
import {Messages, handlersOf, toldOf} from './messages.js';
import {aimedOnDome, arrowOf, steppedLight, still} from './moves.js';
import {Notes} from './notes.js';
import {NotesPane} from './notes_pane.js';
import {Placement, directionOf} from './placement.js';
import {lightWords, withWords} from './png_words.js';
import {Screen} from './screen.js';
import {snapshot} from './snapshot.js';
import {States} from './states.js';

const at = id => document.getElementById(id), canvas = at('picture');
const toolNames = {
  light: ['Light', 'drag: move the light over the painting (L)'], tilt: ['Tilt', 'drag: tilt the painting (T)'],
  pan: ['Move', 'drag: move the painting (H); two fingers or the wheel zoom'], ruler: ['Measure', 'drag: measure a distance and the heights along it (M)'],
  point: ['Point', 'click where it is'], line: ['Line', 'drag from end to end, or click both'],
  polygon: ['Polygon', 'click its corners, at last the first one again'], text: ['Text', 'click where the words begin'],
};
const several = data.states.length > 1;
const state = {
  view: {x: (data.width - 1) / 2, y: (data.height - 1) / 2, zoom: 1, turn: 0}, tilt: still,
  light: {azimuth: data.light_deg[0], elevation: data.light_deg[1]}, colour: '#ffffff', softness: usualSoftness, tool: 'light', look: 0, shadows: true,
  sweeping: false, loupe: false, ruler: null, exposure: 0, ambient: 0.03, shoulder: 0.15, ui: true,
  left: 0, right: data.states.length - 1, divider: 0.5, curtain: several,
  notes: data.annotations.length > 0, selected: null, draft: null, cross: null, measuring: false,
};
const screen = new Screen(canvas, data, state, {free, changed: ask});
let states, told = '';

// True where the address says what part of the painting to show.
function readLink() {
  const words = new URLSearchParams(location.hash.slice(1));
  const aimed = followWords(words, state, data);
  document.body.classList.toggle('bare', !state.ui);
  if (words.has('annotation')) choose(words.get('annotation'));
  return aimed;
}
function link() {
  const chosen = state.selected ? [['annotation', state.selected]] : [];
  return `${location.href.split('#')[0]}#${new URLSearchParams([...wordsOf(state, data), ['tool', state.tool], ...chosen])}`;
}

function draw(moving, part) {
  const placement = hand.placement(), scene = sceneOf(data, state, placement.inSurface(directionOf(state.light)));
  const rectangle = screen.rectangle(part), parts = curtain.parts(rectangle), loupe = loupeShot(placement, part);
  curtain.shown.forEach((k, i) => {
    const all = {camera: placement, rectangle, only: parts[i], part, smooth: !moving};
    states.drawing(k).show(scene, loupe ? [all, {...loupe, only: common(loupe.rectangle, parts[i])}] : [all]);
  });
  lens(loupe, part);
  marked(placement);
  controls();
  tell();
  document.documentElement.dataset.drawn = !moving && states.complete(curtain.shown, state.shadows) ? 'whole' : 'part';
}
function common(a, b) {
  const left = Math.max(a.left, b.left), bottom = Math.max(a.bottom, b.bottom);
  return {left, bottom, width: Math.min(a.left + a.width, b.left + b.width) - left, height: Math.min(a.bottom + a.height, b.bottom + b.height) - bottom};
}

// What is under the cursor four times as large, in a square of the canvas.
function loupeShot(placement, part) {
  const cursor = hand.cursor, under = state.loupe && cursor && placement.toPainting(...cursor);
  if (!under) return null;
  const side = Math.round(Math.min(240 * devicePixelRatio, screen.width / 2, screen.height / 2)), larger = 4;
  const camera = new Placement(data, {...state.view, x: under[0], y: under[1], zoom: state.view.zoom * larger}, state.tilt, {width: side, height: side}, state.held);
  const size = Math.max(1, Math.round(side * part)), middle = v => Math.round(v * part - size / 2);
  return {camera, rectangle: {left: middle(cursor[0]), bottom: middle(screen.height - cursor[1]), width: size, height: size}, part, smooth: true};
}
function lens(loupe, part) {
  at('lens').style.display = loupe ? '' : 'none';
  if (!loupe) return;
  const css = screen.css / part, {left, bottom, width, height} = loupe.rectangle;
  Object.assign(at('lens').style, {left: `${left * css}px`, bottom: `${bottom * css}px`, width: `${width * css}px`, height: `${height * css}px`});
}

const frames = new Frames({advance: seconds => hand.advance(seconds), moving: () => hand.holds && hand.drag !== 'ruler' && hand.drag !== 'mark', draw});
function ask() { if (states) frames.ask(); }

// What lies over the picture, and the heights along the ruler once it rests.
function marked(placement) {
  const {css} = screen, toCss = p => placement.toScreen(...p).map(v => v * css), {ruler} = state;
  const words = ruler ? length(Math.hypot(ruler[1][0] - ruler[0][0], ruler[1][1] - ruler[0][1])) : '';
  marks.draw({...state, items: state.notes ? notes.items : []}, toCss, words);
  pane.draw(state.selected);
  const rests = ruler && (ruler[0][0] !== ruler[1][0] || ruler[0][1] !== ruler[1][1]);
  if (!rests) profile.close();
  else if (hand.drag !== 'ruler' && !state.measuring) profile.show(ruler, curtain.shown);
}

function controls() {
  const {elevation} = state.light, azimuth = Math.round(state.light.azimuth + 360) % 360, d = directionOf(state.light);
  at('light').setAttribute('cx', 50 + 46 * d[0]);
  at('light').setAttribute('cy', 50 - 46 * d[1]);
  at('light').style.fill = state.colour;
  at('angles').textContent = `${azimuth}° · ${Math.round(elevation)}° high`;
  at('dome').setAttribute('aria-valuenow', azimuth);
  at('dome').setAttribute('aria-valuetext', `azimuth ${azimuth}, elevation ${Math.round(elevation)} degrees`);
  for (const button of document.querySelectorAll('[data-tool]')) button.setAttribute('aria-pressed', button.dataset.tool === state.tool);
  at('follow').setAttribute('aria-pressed', held.runs);
  at('level').disabled = !held.runs;
  for (const key of ['shadows', 'loupe', 'sweeping', 'curtained']) at(key).setAttribute('aria-pressed', state[key === 'curtained' ? 'curtain' : key]);
  at('noted').setAttribute('aria-expanded', pane.isOpen);
  at('right').hidden = !state.curtain;
  for (const key of ['look', 'exposure', 'colour', 'softness', 'left', 'right']) if (document.activeElement !== at(key)) at(key).value = state[key];
  at('softness').disabled = !state.shadows;
  canvas.style.cursor = {light: 'crosshair', tilt: 'grab', pan: 'move'}[state.tool] ?? 'crosshair';
  curtain.draw();
  scaleBar();
}
const millimetres = mm => mm >= 1000 ? `${(mm / 1000).toFixed(2)} m` : mm >= 100 ? `${mm.toFixed(0)} mm` : `${mm.toFixed(mm >= 10 ? 1 : 2)} mm`;
const length = pixels => data.scale_known ? millimetres(pixels * data.mm_per_pixel) : `${pixels.toFixed(pixels < 10 ? 1 : 0)} px`;

// 1, 2 or 5 times a power of ten, about a tenth of the screen; true where the painting is not tilted.
function scaleBar() {
  const unit = data.scale_known ? data.mm_per_pixel : 1, {css} = screen;
  const most = 140 / (state.view.zoom * css) * unit, power = 10 ** Math.floor(Math.log10(most));
  const shown = [5, 2, 1].find(n => n * power <= most) * power;
  at('bar').style.width = `${shown / unit * state.view.zoom * css}px`;
  at('bar-length').textContent = data.scale_known ? shown < 1 ? `${+(1000 * shown).toPrecision(1)} µm` : shown >= 1000 ? `${shown / 1000} m` : `${shown} mm` :
    `${+shown.toPrecision(1)} px`;
}

// Rectangles of the screen that the caption and the dome leave free: below both, between them, or below the one and
// beside the other. Where they leave too little, the whole screen.
function free() {
  const stage = canvas.getBoundingClientRect(), toScreen = screen.width / Math.max(stage.width, 1), gap = 8;
  const whole = {x0: 0, y0: 0, x1: screen.width, y1: screen.height};
  const panes = ['caption', 'lighting'].map(id => at(id).getBoundingClientRect()).filter(box => box.width > 0);
  const [caption, lighting] = panes.map(box => ({x0: (box.left - stage.left - gap) * toScreen, x1: (box.right - stage.left + gap) * toScreen,
    y1: (box.bottom - stage.top + gap) * toScreen}));
  if (!lighting) return [whole];
  const candidates = [{...whole, y0: Math.max(caption.y1, lighting.y1)}, {...whole, x0: caption.x1, x1: lighting.x0},
    {...whole, x1: lighting.x0, y0: caption.y1}, {...whole, x0: caption.x1, y0: lighting.y1}];
  const usable = candidates.filter(r => r.x1 - r.x0 > 0.3 * screen.width && r.y1 - r.y0 > 0.3 * screen.height);
  return usable.length ? usable : [whole];
}

function caption() {
  document.title = data.title;
  at('title').textContent = data.title;
  const size = data.scale_known ? [`${millimetres(data.width * data.mm_per_pixel)} × ${millimetres(data.height * data.mm_per_pixel)}`] : [];
  at('size').textContent = [...size, `${data.width} × ${data.height} pixels`].join(' · ');
  at('credit').textContent = [data.creator, data.credit].filter(Boolean).join(' · ');
  const {program, version, photographs} = data.origin;
  at('origin').textContent = [photographs > 0 ? `Shape and gloss were fitted from ${photographs} photographs.` : 'Relief and gloss are shown as its maps say.',
    program ? `Made with ${program}${version ? ` ${version}` : ''}.` : ''].join(' ');
}

// A tool's button; drawing tools stand in the pane of the annotations.
function addTool(name) {
  const button = document.createElement('button'), [text, help] = toolNames[name];
  Object.assign(button, {textContent: text, title: help, onclick: () => {
    Object.assign(state, {tool: name, draft: null, cross: null});
    say(`${text}: ${help}.`);
    ask();
  }});
  button.dataset.tool = name;
  at(['point', 'line', 'polygon', 'text'].includes(name) ? 'pens' : 'tools').append(button);
}

function setUp() {
  toolWords.forEach(addTool);
  data.looks.forEach(({name}, value) => at('look').append(new Option(name, value)));
  for (const id of ['left', 'right']) data.states.forEach(({name}, value) => at(id).append(new Option(name, value)));
  at('states').hidden = !several;
  at('softness').max = mostSoftness;
  for (const key of ['look', 'exposure', 'softness', 'left', 'right']) at(key).addEventListener('input', () => { state[key] = +at(key).value; ask(); });
  at('colour').addEventListener('input', () => { state.colour = at('colour').value; ask(); });
  for (const key of ['shadows', 'loupe', 'sweeping']) at(key).onclick = () => { state[key] = !state[key]; ask(); };
  at('curtained').onclick = () => { state.curtain = !state.curtain; ask(); };
  at('follow').onclick = follow;
  at('level').onclick = () => { held.setLevel(); };
  at('shadows').hidden = data.states.every(s => s.horizon[0] === 0);
  for (const [id, key] of [['fit', 'f'], ['one', '1'], ['straight', 'r']]) at(id).onclick = () => { hand.key({key}); ask(); };
  at('full').hidden = !document.fullscreenEnabled;
  at('full').onclick = () => document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen?.();
  at('link').onclick = () => {
    location.replace(link());
    navigator.clipboard?.writeText(location.href).then(() => { say('The link to this view has been copied.'); }, () => {});
  };
  at('snap').onclick = () => picture().then(blob => saveAs(blob, `${data.title}.png`), error => show(error.message));
  at('noted').onclick = () => { openNotes(!pane.isOpen); };
  for (const [button, shown] of [['more', 'further'], ['light-look-opens', 'light-look']]) at(button).onclick = () => {
    const opens = at(button).getAttribute('aria-expanded') !== 'true';
    at(button).setAttribute('aria-expanded', opens);
    if (shown === 'light-look') at('light-look').hidden = !opens;
  };
  at('profile').querySelector('.close').onclick = () => { state.ruler = null; ask(); };
  window.addEventListener('hashchange', () => { readLink(); ask(); });
  listen();
  screen.observe();
}
function listen() {
  const aim = event => {
    state.sweeping = false;
    state.light = aimedOnDome(at('dome'), event);
    ask();
  };
  at('dome').addEventListener('pointerdown', event => { at('dome').setPointerCapture(event.pointerId); aim(event); });
  at('dome').addEventListener('pointermove', event => { if (event.buttons) aim(event); });
  document.addEventListener('keydown', event => {
    if (event.target.closest('button, select, input, textarea, summary')) return;
    const arrows = event.target === at('dome') && !event.shiftKey && arrowOf(event);
    if (arrows) Object.assign(state, {sweeping: false, light: steppedLight(state.light, arrows)});
    else if (event.key.toLowerCase() === 'n' && !event.ctrlKey && !event.metaKey && !event.altKey) openNotes(!pane.isOpen);
    else if (!hand.key(event)) return;
    event.preventDefault();
    ask();
  });
  canvas.addEventListener('webglcontextlost', event => event.preventDefault());
  canvas.addEventListener('webglcontextrestored', () => location.reload());
}

// Annotations.
function openNotes(opens) {
  pane.open(opens);
  state.notes = opens || notes.items.length > 0 && state.notes;
  if (!opens && pen.draws) Object.assign(state, {tool: 'light', draft: null, cross: null});
  (opens ? at('notes').querySelector('h2') : at('noted')).focus();
  ask();
}
// One of them with its light, view and look; null for none.
function choose(id) {
  const item = notes.find(id);
  state.selected = item ? id : null;
  if (item) {
    state.notes = true;
    const ring = item.shape.rings[0], mean = i => ring.reduce((sum, p) => sum + p[i], 0) / ring.length;
    if (!followWords(new URLSearchParams(item.view), state, data)) state.view = {...state.view, x: mean(0), y: mean(1)};
    pane.pane.hidden = false;
    say(`Annotation: ${item.text || 'without text'}`);
  }
  messages?.tell('selected', {annotation: state.selected});
  ask();
}
function drawn(shape) {
  const id = notes.add(shape, shape.kind === 'text' ? 'Text' : '', wordsOf(state, data).toString());
  state.notes = true;
  choose(id);
  pane.edit(id);
  ask();
}

// A PNG of what is shown, once it is there as fine as it can be.
async function picture() {
  const waits = performance.now() + 20000;
  while (!states.complete(curtain.shown, state.shadows) && performance.now() < waits) await new Promise(resolve => setTimeout(resolve, 50));
  const words = {Title: data.title, Author: data.creator, Copyright: data.credit, Description: lightWords(data, state), Source: data.id === data.title ? '' : data.id, Software: data.software};
  return withWords(await snapshot(canvas, at('overlay'), () => draw(false, 1), state.curtain ? state.divider * screen.width : null), words);
}

// What is shown, to pages that listen, where it has changed.
function tell() {
  const words = JSON.stringify(toldOf(state, data));
  if (words !== told && told) messages?.tell('changed', JSON.parse(words));
  told = words;
}

// The light follows how the device is held, where it has a sensor.
const held = new HeldScreen(() => {
  state.held = held.matrix;
  ask();
});
// Words for who hears the page; and for all to see, for a while.
function say(text) { at('said').textContent = text; }
function show(text) {
  say(text);
  at('said').className = 'pane';
  setTimeout(() => { at('said').className = 'unseen'; }, 5000);
}
async function follow() {
  if (held.runs) {
    held.stop();
    state.held = undefined;
  } else {
    const answer = await held.start();
    show(tiltRefusals[answer] ?? 'Tilt the device: the light stays in the room.');
  }
  ask();
}

const pen = new MarkPen(data, state, drawn, say), hand = new InputController(data, state, screen, pen, ask);
const curtain = new Curtain(at('curtain'), data, state, ask), marks = new Marks(at('overlay'), at('badges'), id => { choose(id); });
const notes = new Notes(data, () => {
  if (state.selected && !notes.find(state.selected)) state.selected = null;
  messages?.tell('annotations', {annotations: notes.page()});
  ask();
}, show);
const pane = new NotesPane(at('notes'), notes, {choose, view: () => wordsOf(state, data).toString(), told: show, title: data.title});
let messages, profile;
try {
  caption();
  screen.placed = readLink();
  if (typeof DecompressionStream === 'undefined') throw new Error('tiles cannot be inflated');
  const missed = name => { say(`${name} could not be loaded; it is tried again.`); };
  states = new States(canvas, data, screen.tiles, ask, missed);
  curtain.shown.forEach(k => states.drawing(k));
  profile = new ProfilePane(at('profile'), states, show);
  setUp();
  messages = new Messages(data.origins, handlersOf({state, data, notes, select: choose, ask, snapshot: picture}));
} catch (error) {
  document.body.classList.add('failed');
  at('failed').hidden = false;
  console.error(error);
}
