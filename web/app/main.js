// main.js: the page as a whole: gallery and easel, and what each control does.

import {fillBrushSheet, nameOf} from './brush_sheet.js';
import {RoomLight, lightOf} from './camera.js';
import {Connection} from './connection.js';
import {Sheets, ask, at, busy, busyPart, notice} from './controls.js';
import {showGallery} from './gallery.js';
import {Immersive, inRoomIsThere} from './immersive.js';
import {Input} from './input.js';
import {fillLightSheet} from './light_sheet.js';
import {askForPainting, decoded} from './new_painting.js';
import {ontoEngine, ontoGround} from './opening.js';
import {fillPaintingSheet, rescue} from './painting_sheet.js';
import {Board, css, fillPaletteSheet} from './palette_sheet.js';
import {HeldScreen} from './shared/held.js';
import {arrowOf, steppedLight, still} from './shared/moves.js';
import {pngOf} from './share.js';
import {Storage} from './storage.js';
import {StrokeLines, endLine} from './strokes.js';
import {View} from './view.js';
import {Work} from './work.js';

const tool = {preset: 'flat', size: 10, load: 1, pressure: {from: 'pen', value: 0.6}, dirty: false, stabiliser: 0, paint: {'Ultramarine Blue': 1}, mixing: false,
  finish: {own: false, specular: 0.04, roughness: 0.3, medium: 0}, page: 'paints', erasing: false, sampling: false, goesOn: false, hand: 'paint'};
const look = {tilt: still, held: null, light: {azimuth: 135, elevation: 50}, lightInHand: false, look: 0, shadows: false, exposure: 0, ambient: 0.03, shoulder: 0.15};
const limits = {least: 1, most: 60};
// [ms] What painting it again would take for which the engine's memory is kept: when the painter leaves, and while the hand rests.
const shortAgain = 1000, longAgain = 8000, restsAfter = 15000;
let storage, connection, open = null, thumbnailDue = 0, imageDue = 0;

const redraw = () => open?.view.ask();
const held = new HeldScreen(() => {
  look.held = held.matrix;
  open?.view.moving();
});
const room = new RoomLight(at('room'), () => look.lightInHand ? null : look.held, direction => {
  look.light = lightOf(direction);
  redraw();
});
const inRoom = new Immersive(at('in-room'), redraw);
let hasRoom = false;
async function intoRoom() {
  const words = await inRoom.start(open.view);
  if (words) notice(words, true);
}
at('leave-room').onclick = () => inRoom.stop();
at('in-room').addEventListener('beforexrselect', event => { if (event.target.closest('button')) event.preventDefault(); });
const sheets = new Sheets(() => open?.view?.screen.refit());

// ---- Strokes
function strokeTool(palette, erase) {
  const loads = !erase && !['smudge', 'scrape'].includes(tool.preset) && !tool.goesOn && !palette;
  const brush = erase ? {preset: 'eraser', size_mm: +tool.size.toFixed(2)} : {preset: tool.preset, size_mm: +tool.size.toFixed(2)};
  const {own, specular, roughness, medium} = tool.finish;
  const finish = {...(own ? {specular: +specular.toFixed(4), roughness: +roughness.toFixed(4)} : {}), ...(medium > 0.004 ? {medium: +medium.toFixed(3)} : {})};
  return {brush, paint: loads ? tool.paint : null, load: +tool.load.toFixed(3), start: loads ? tool.dirty ? 'dirty' : 'clean' : erase ? 'clean' : 'same',
    finish, pressure: tool.pressure, palette, stabiliser: +tool.stabiliser.toFixed(1)};
}
function beginStroke(event, place, palette = false, erase = tool.erasing) {
  if (palette && !open.hasBoard) return null;
  const stroke = new StrokeLines(strokeTool(palette, erase), open.work.seed(), palette ? 0 : look.view.turn, place);
  open.work.send([stroke.first, ...stroke.points(event)], false);
  if (palette) tool.goesOn = true;
  return stroke;
}
const addToStroke = (stroke, event) => open.work.send(stroke.points(event), false);
function endStroke(stroke, event) {
  open.work.send([...event.type === 'pointerup' ? stroke.points(event) : [], endLine], true);
  clearTimeout(thumbnailDue);
  thumbnailDue = setTimeout(keepThumbnail, 4000);
  clearTimeout(imageDue);
  imageDue = setTimeout(() => keepImage(longAgain, true), restsAfter);
}
function apply(event) {
  if (open.work.lines) return;  // a stroke is under way
  open.work.event(event);
}

// ---- What the engine tells
function connect() {
  connection = new Connection({
    changed: parts => open?.view.take(parts),
    board: takeBoard,
    state: (state, brush) => {
      if (!open) return;
      Object.assign(open, {state, brush});
      showTools();
      if (sheets.open === 'painting') sheets.refresh('painting');
      if (look.shadows) shadowsLater();
    },
    told: text => {
      if (/no longer be undone/.test(text)) notice('The oldest strokes can no longer be undone.');
      else if (!/changes nothing/.test(text)) notice(text);
    },
    failed: (message, stroke) => {
      open?.work.refuse(stroke);
      notice(message);
    },
    progress: busyPart,
    painted: waiting => { document.documentElement.dataset.waiting = waiting; },
    died: () => stopped('The engine ran out of memory or stopped. What was painted is kept: open the painting again.'),
  });
  return connection.ask('load', {url: new URL('.', import.meta.url).href});
}
function takeBoard(picture) {
  if (!open || !picture) return;
  open.hasBoard = true;
  open.board.take(picture, open.picture.mm_per_pixel);
}
let shadowsDue = 0;
function shadowsLater() {
  clearTimeout(shadowsDue);
  shadowsDue = setTimeout(() => { if (open && look.shadows && !open.work.lines) open.view.loadHorizon(); }, 1200);
}
async function stopped(words) {
  busy(null);
  await ask('The painting was closed', words, [[true, 'Back to all paintings', 'first']]);
  location.hash = '';
  location.reload();
}

// ---- The easel
async function openWork(record) {
  if (!await storage.take(record.id)) throw new Error('It is open in another tab or window. Go on there, or close it there first.');
  busy('Preparing the canvas…');
  const {next, ...begun} = await ontoEngine(storage, connection, record), {picture} = begun;
  record.head = begun.head;  // what its journal goes on from
  open = {...begun, connection, hasBoard: false, board: new Board({begin: (event, place) => beginStroke(event, place, true), add: addToStroke, end: endStroke})};
  takeBoard(await connection.ask('board'));
  open.work = new Work(storage, connection, record, next, {kept: keepsWell, full: storageFull, lost: message => notice(`The last strokes are not kept yet: ${message}`, true)});
  at('gallery').hidden = true;
  at('easel').hidden = false;
  Object.assign(look, {view: undefined, tilt: still, look: 0});
  show();
  tool.goesOn = Boolean(open.state?.goes_on);
  limits.most = Math.max(8, Math.min(picture.width, picture.height) * picture.mm_per_pixel / 3);
  at('work-title').textContent = document.title = record.title;
  location.hash = record.id;
  showTools();
  busy(null);
  storage.persist();
  warnOfRoom();
}
// What is open, on the canvas.
function show() {
  open.view?.close();
  open.view = input.view = new View(at('picture'), look, open.picture, connection, {room, holds: () => input.holds,
    covered: () => sheets.open === 'light' ? at('sheet-light').getBoundingClientRect() : null});
}
async function closeWork() {
  sheets.close();
  room.stop();
  held.stop();
  look.held = null;
  await keepThumbnail();
  await open?.work.write();
  keepImage(shortAgain);
  input.view = null;
  open?.view.close();
  open = null;
  storage.give();
  location.hash = '';
  document.title = 'TangiPaint';
  at('easel').hidden = true;
  at('gallery').hidden = false;
  await showGallery(storage, gallery);
}
async function keepThumbnail() {
  clearTimeout(thumbnailDue);
  if (!open || open.work.lines) return;
  const {record} = open.work;
  try {
    await storage.keepThumbnail(record.id, await pngOf(await connection.ask('thumbnail', {size: 360})));
  } catch (error) {
    console.warn(error);  // the next one may fit
  }
}
// Keeps the engine's memory, where painting the work again would take so long.
function keepImage(worth, rests = false) {
  clearTimeout(imageDue);
  const work = open?.work;
  if (work && !work.lines && !work.unstored) connection.ask('keep', {work: work.record.id, next: work.next, worth, rests}).catch(error => console.warn(error));
}
// The page may be closed at any time from here on.
async function leave() {
  await open?.work.write();
  keepImage(shortAgain);
  await keepThumbnail();
}
// The same painting on a ground that looks otherwise.
async function reground(choice) {
  const {work: {record}} = open;
  busy('Preparing the ground…');
  try {
    const {picture, head} = await ontoGround(storage, connection, {...record, choice});
    await storage.change(record.id, {choice});
    Object.assign(record, {choice, head});
    open.picture = picture;
    show();
  } catch (error) {
    notice(`The ground stays as it was: ${error.message}`, true);
  }
  busy(null);
}
async function rename(title) {
  open.work.record.title = title.trim() || 'Untitled';
  at('work-title').textContent = document.title = open.work.record.title;
  await storage.change(open.work.record.id, {title: open.work.record.title});
}

// ---- Storage
let warned = false;
let kept = 0;
const looksForRoom = 16;  // strokes
function keepsWell() {
  document.documentElement.dataset.unstored = 0;
  if (++kept % looksForRoom === 0) warnOfRoom();
  if (warned) notice('');
  warned = false;
}
async function storageFull(count) {
  document.documentElement.dataset.unstored = count;
  if (warned) return;
  warned = true;
  notice('The storage of this device is full: the last strokes are not kept.', true);
  const answer = await ask('Storage is full', 'The last strokes are on the painting, but this device has no room to keep them. Save the journal now, or make room and paint on.',
    [[null, 'Paint on'], ['save', 'Save the journal', 'first']]);
  if (answer === 'save') rescue(open.work);
}
async function warnOfRoom() {
  const {low, left} = await storage.room();
  if (low) notice(`The storage of this device is nearly full: ${Math.max(0, Math.round(left / 1e6))} MB are left. Take works along before you paint on.`, true);
}

// ---- Controls
function showTools() {
  at('brush-icon').setAttribute('href', `#i-${tool.preset}`);
  at('brush-label').textContent = nameOf(tool.preset);
  at('open-brush').setAttribute('aria-label', `${nameOf(tool.preset)} brush`);
  at('eraser').setAttribute('aria-pressed', tool.erasing);
  at('sampler').setAttribute('aria-pressed', tool.sampling);
  at('colour').style.background = css(tool.goesOn ? open?.brush?.rgb ?? null : mixtureColour());
  at('undo').disabled = !open?.state.can_undo;
  at('redo').disabled = !open?.state.can_redo;
  at('size-quick').value = Math.log(tool.size / limits.least) / Math.log(limits.most / limits.least);
  at('size-quick').setAttribute('aria-valuetext', `${tool.size.toFixed(1)} mm`);
}
function mixtureColour() {
  const parts = Object.entries(tool.paint), sum = parts.reduce((all, [, part]) => all + part, 0);
  const rgb = [0, 1, 2].map(i => parts.reduce((all, [name, part]) => all + part / sum * (open?.paints.find(p => p.name === name)?.rgb[i] ?? 128), 0));
  return rgb.map(Math.round);
}
function showTip(event) {
  const tip = at('tip');
  if (!event || tool.hand !== 'paint') {
    tip.style.opacity = 0;
    return;
  }
  // Where the browser says that the pen will be, so that the ring does not trail behind it.
  const next = event.getPredictedEvents?.().at(-1) ?? event, css = open.view.cssOf(tool.size);
  Object.assign(tip.style, {opacity: 1, width: `${css}px`, height: `${css}px`, transform: `translate(${next.clientX - css / 2}px, ${next.clientY - css / 2}px)`});
}
async function sample(event) {
  const at_ = open.view.place(event);
  const found = at_ && await connection.ask('sample', {palette: false, x: at_[0], y: at_[1], radius: 0.5});
  if (!found) return;
  if (!Object.keys(found.recipe).length) {
    notice('There is no paint here to sample.');
    return;
  }
  const recipe = Object.fromEntries(Object.entries(found.recipe).filter(([name]) => open.paints.some(p => p.name === name)).map(([name, part]) => [name, +(10 * part).toFixed(2)]));
  if (!Object.keys(recipe).length) return;
  Object.assign(tool, {paint: recipe, goesOn: false});
  notice(Object.keys(recipe).join(' + '));
  showTools();
}

const input = new Input(at('picture'), {
  tool: () => tool.sampling ? 'sample' : tool.hand,
  begin: (event, erase) => beginStroke(event, e => open.view.place(e), false, erase || tool.erasing),
  add: addToStroke, end: endStroke, sample, undo: () => undo('undo'), redo: () => undo('redo'), changed: () => open?.view.moving(), tip: showTip});

function undo(event) {
  if (open?.state[`can_${event}`]) apply({event});
}
const changed = () => { showTools(); redraw(); };
sheets.add('brush', 'Brush', sheet => fillBrushSheet(sheet, tool, limits, changed));
sheets.add('palette', 'Paints', sheet => fillPaletteSheet(sheet, {tool, paints: open.paints, board: open.board, changed,
  startBoard: () => apply({event: 'palette', paints: Object.keys(tool.paint).length > 1 ? Object.keys(tool.paint) : open.paints.slice(0, 12).map(p => p.name)}),
  wipe: () => apply({event: 'palette', paints: []}), wash: () => { tool.goesOn = false; apply({event: 'wash'}); showTools(); }}));
sheets.add('light', 'Light and tilt', sheet => fillLightSheet(sheet, {view: open.view, held, tool, room, intoRoom: hasRoom ? intoRoom : null, changed, again: () => sheets.refresh('light')}));
sheets.add('painting', 'Painting', sheet => fillPaintingSheet(sheet, {open, apply, rename, reground}));
at('eraser').onclick = () => { Object.assign(tool, {erasing: !tool.erasing, sampling: false}); changed(); };
at('sampler').onclick = () => { Object.assign(tool, {sampling: !tool.sampling, erasing: false}); changed(); };
at('undo').onclick = () => undo('undo');
at('redo').onclick = () => undo('redo');
at('fit').onclick = () => open.view.fit();
at('to-gallery').onclick = () => closeWork();
at('size-quick').oninput = () => {
  tool.size = limits.least * (limits.most / limits.least) ** Number(at('size-quick').value);
  notice(`${tool.size < 10 ? tool.size.toFixed(1) : Math.round(tool.size)} mm`);
  showTools();
};
document.addEventListener('keydown', event => {
  if (!open || event.target.closest?.('input, select, textarea, dialog, #dome')) return;
  const command = event.ctrlKey || event.metaKey, key = event.key.toLowerCase();
  const arrow = arrowOf(event);
  if (command && key === 'z') undo(event.shiftKey ? 'redo' : 'undo');
  else if (command && key === 'y') undo('redo');
  else if (command) return;
  else if (arrow) look.light = steppedLight(look.light, arrow);
  else if (key === 'f') open.view.fit();
  else if (key === 'e') at('eraser').click();
  else return;
  event.preventDefault();
  redraw();
});
document.addEventListener('visibilitychange', () => { if (document.hidden) leave(); });
at('picture').addEventListener('webglcontextlost', event => event.preventDefault());
at('picture').addEventListener('webglcontextrestored', () => location.reload());

// ---- Works
const gallery = {
  open: record => openWork(record).catch(couldNotOpen),
  removed: record => connection.ask('forget', {work: record.id}),
  create: async () => {
    const wanted = await askForPainting((await storage.works()).length);
    if (wanted) await create(wanted).catch(couldNotOpen);
  },
};
async function couldNotOpen(error) {
  console.error(error);
  busy(null);
  await ask('The painting cannot be opened', error.message, [[null, 'Close']]);
}
// The lines of events of a journal's file. Throws where it is none.
async function eventsOf(journal) {
  const lines = (await journal.text()).split(/\r\n?|\n/).filter(line => line.trim());
  if (!lines.shift()?.includes('tangipaint strokes')) throw new Error(`${journal.name} is no journal of TangiPaint.`);
  return lines.map(line => `${line}\n`).join('');
}
async function create({title, choice, picture, relief, journal = null}) {
  busy('Preparing the canvas…');
  if (choice.picture) {
    // The pixels that it is painted on are kept as they are: another decoder would have others.
    const pixels = await decoded(picture, choice.most_pixels), {long_mm, most_pixels, ...rest} = choice;
    picture = await pngOf(pixels);
    choice = {...rest, pixel_mm: long_mm / Math.max(pixels.width, pixels.height)};
    if (most_pixels && relief) relief = await pngOf(await decoded(relief, most_pixels, pixels));
  }
  const events = journal ? await eventsOf(journal) : '', record = await storage.begin({title, choice, picture, relief});
  if (events) await storage.append(record.id, 0, events);
  try {
    await openWork(record);
  } catch (error) {
    await storage.remove(record.id);
    throw error;
  }
}

function cannotDraw(words) {
  at('failed').hidden = false;
  at('failed-words').textContent = words;
}
async function begin() {
  const probe = document.createElement('canvas').getContext('webgl2');
  if (!probe) return cannotDraw('The painting is drawn with WebGL 2, which this browser does not have or has switched off. Any browser since 2023 with hardware acceleration will do; look for “hardware acceleration” in its settings.');
  probe.getExtension('WEBGL_lose_context')?.loseContext();
  if (typeof WebAssembly === 'undefined' || !WebAssembly.validate(new Uint8Array([0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11])))
    return cannotDraw('The paint is computed with vector instructions of WebAssembly, which this browser does not have. Any browser since 2023 will do.');
  try {
    storage = await Storage.open(async () => {
      await open?.work.write();
      stopped('A newer TangiPaint was opened in another tab. What was painted is kept: the painting goes on there.');
    });
  } catch (error) {
    return cannotDraw(`Paintings are kept in the browser’s storage, which is closed to this page (${error.message}). Private windows of some browsers have none: open TangiPaint in an ordinary one.`);
  }
  navigator.serviceWorker?.register('service_worker.js').catch(error => console.warn('no offline use:', error.message));
  inRoomIsThere().then(is => { hasRoom = is; });
  await connect();
  const id = location.hash.slice(1), record = id && await storage.work(id);
  at('gallery').hidden = Boolean(record);
  if (record) await gallery.open(record);
  if (!open) {
    at('gallery').hidden = false;
    await showGallery(storage, gallery);
  }
  document.documentElement.dataset.ready = 'yes';
}
begin().catch(error => {
  console.error(error);
  cannotDraw(`It could not begin: ${error.message}`);
});
// For tests and benchmarks.
window.tangipaint = {tool, look, get open() { return open; }, get storage() { return storage; }, get connection() { return connection; }, create};
