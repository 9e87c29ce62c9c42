// worker.js: the engine's own thread, so that looking never waits for painting. Lines of the journal come in; what they change
// goes out as texels of the tiles that the page has.

import {Engine} from './engine.js';
import makeEngine from './engine.mjs';
import {forget, keepImage, recallImage} from './memory_image.js';
import {paintingFile, partsOf} from './painting_file.js';

const paintAtOnce = 24, settleAfter = 120;  // [ms]
const lines = [], delivered = new Set(), refused = new Set();
let engine, waiting = false, settling = 0;
// What is open: its picture (web_picture_data()), what it was opened with, and the number of the record that comes next in its
// journal; how long that took since its memory was kept last [ms].
let open = {picture: {width: 0, height: 0}, next: 0, ms: 0};
let program = null, build = '';  // engine.wasm, and its SHA-256

const post = (message, transfer = []) => self.postMessage(message, transfer);
const tellPart = part => post({event: 'progress', part});

// Texels of what changed, of each level of which the page has a tile there.
function show(regions) {
  const shownLevels = new Set([...delivered].map(name => +name.split('/')[0])), parts = [];
  for (const level of shownLevels)
    for (const region of regions) {
      const {width, height} = open.picture, scale = 2 ** level, x0 = Math.floor(region.x0 / scale), y0 = Math.floor(region.y0 / scale);
      const x1 = Math.min(Math.ceil(region.x1 / scale), Math.ceil(width / scale));
      const y1 = Math.min(Math.ceil(region.y1 / scale), Math.ceil(height / scale));
      parts.push({level, region: {x0, y0, x1, y1}, texels: engine.texels(level, {x0, y0, x1, y1})});
    }
  if (parts.length) post({event: 'changed', parts}, parts.map(p => p.texels.buffer));
}
function refresh(all) {
  const regions = engine.refresh(all);
  if (regions.length) show(regions);
  const board = engine.picture('board', 0);
  if (board) post({event: 'board', board}, [board.bytes.buffer]);
  return regions.length > 0;
}
function settle() {
  clearTimeout(settling);
  settling = setTimeout(() => { if (!lines.length && engine && refresh(true)) settle(); }, settleAfter);
}

// What is in the queue, for as long as a frame has; then what it has changed.
function work() {
  waiting = false;
  const from = performance.now(), end = from + paintAtOnce;
  let ends = false;
  while (lines.length && performance.now() < end) {
    const {line, stroke} = lines.shift();
    if (refused.has(stroke)) continue;  // the rest of a stroke that could not begin
    try {
      const told = engine.apply(line);
      if (told) post({event: 'told', told, stroke});
      ends ||= !line.startsWith('{"event":"point"');
      if (!/^{"event":"(stroke|point)"/.test(line)) open.next = stroke + 1;
    } catch (error) {
      refused.add(stroke);
      post({event: 'failed', message: error.message, stroke});
    }
  }
  refresh(false);
  open.ms += performance.now() - from;
  if (ends) post({event: 'state', state: engine.json('state'), brush: engine.json('on_brush')});
  if (lines.length) ask();
  else settle();
  post({event: 'painted', waiting: lines.length});
}
function ask() {
  if (waiting) return;
  waiting = true;
  setTimeout(work, 0);
}

async function start() {
  engine = await Engine.load(options => makeEngine({...options, wasmBinary: program}));
}
function begun(now) {
  open = now;
  lines.length = 0;
  delivered.clear();
  refused.clear();
  return {picture: open.picture, paints: engine.json('paints'), state: engine.json('state'), head: engine.json('head')};
}

const calls = {
  async load({url}) {
    program = await (await fetch(new URL('engine.wasm', url))).arrayBuffer();
    build = [...new Uint8Array(await crypto.subtle?.digest('SHA-256', program) ?? [])].map(v => v.toString(16).padStart(2, '0')).join('');
    await start();
    return {brushes: engine.json('brushes')};
  },
  // work: its id; choice: web/engine/ground.h.
  open({work, choice, picture, relief, file}) {
    return begun({picture: file ? engine.openPainting(partsOf(file, tellPart)) : engine.open(choice, picture, relief), work, choice: JSON.stringify(choice), next: 0, ms: 0});
  },
  // What is open, as if it had been painted on another ground of the same relief.
  lieOn({choice, picture, relief}) {
    Object.assign(open, {picture: engine.lieOn(choice, picture, relief), choice: JSON.stringify(choice), ms: Infinity});  // the image is of another
    delivered.clear();
    return {picture: open.picture, head: engine.json('head')};
  },
  // The same, as its memory was kept; null where it was not. `next`: the number of the first record that is not in it.
  async recall({work, choice, next: most}) {
    const wanted = JSON.stringify(choice);
    const head = await recallImage(h => h.build === build && h.work === work && h.choice === wanted && h.next <= most, bytes => engine.memory(bytes)).catch(async error => {
      console.warn(error.message);
      await start();  // what it knew may be overwritten
    });
    if (!head) return null;
    const {picture, next} = head, answer = begun({picture, work, choice: wanted, next, ms: 0});
    return {...answer, next, brush: engine.json('on_brush')};
  },
  // Keeps the memory of what is open, where it is this work up to this record, and painting it again would take `worth` ms. While the
  // hand rests: only until the engine is wanted again.
  async keep({work, next, worth, rests = false}) {
    const {storage} = navigator, {usage = 0, quota = Infinity} = await storage?.estimate?.() ?? {};
    if (!build || !storage?.getDirectory || open.ms < worth || quota - usage < 2 * engine.memory().length) return false;
    let {calls} = engine;
    const kept = await keepImage(() => {
      if (lines.length || open.work !== work || open.next !== next) return null;
      const {picture, choice} = open;
      ({calls} = engine);
      return {memory: engine.memory(), head: {build, work, choice, next, picture}};
    }, rests && (() => new Promise(resolve => setTimeout(() => resolve(engine.calls === calls)))));
    if (kept) open.ms = 0;
    return kept;
  },
  forget: ({work}) => forget(work),
  board: () => engine.picture('board', 1),
  // Lines of a journal, as they are stored, up to the record before `next`; tells how far it is.
  replay({text, next}) {
    const all = text.split('\n').filter(line => line.trim()), told = [], from = performance.now();
    let last = 0;
    all.forEach((line, i) => {
      if (i === 0 && line.includes('"format"')) {
        engine.begin(line);
        return;
      }
      const words = engine.apply(line);
      if (words) told.push(words);
      const now = performance.now();
      if (now - last < 100) return;
      last = now;
      tellPart(i / all.length);
    });
    engine.refresh(false);
    open.next = next;
    open.ms += performance.now() - from;
    return {told, state: engine.json('state'), brush: engine.json('on_brush')};
  },
  tile({name, level, x, y, width: columns, height: rows}) {
    delivered.add(name);
    const x0 = 256 * x, y0 = 256 * y;
    return engine.texels(level, {x0, y0, x1: x0 + columns, y1: y0 + rows});
  },
  sample: ({palette, x, y, radius}) => engine.json('sample', palette ? 1 : 0, x, y, radius),
  thumbnail: ({size}) => engine.picture('thumbnail', size),
  layers: () => engine.json('layers').map((name, i) => ({name, ...engine.picture('layer', i)})),
  horizon({side}) {
    const size = engine.json('horizon', side);
    return {...size, values: engine.bytes()};
  },
  // A Blob: the painting file; `original` is the one that it is painted on.
  file: ({original}) => paintingFile(engine, original && partsOf(original), tellPart),
  hash: () => engine.json('hash'),
  totals: () => ({...engine.json('totals'), memory: engine.memory().length}),
};

self.onmessage = async ({data}) => {
  if (data.lines) {
    lines.push(...data.lines.map(line => ({line, stroke: data.stroke})));
    ask();
    return;
  }
  if (data.left) {
    delivered.delete(data.left);
    return;
  }
  // What is asked comes after what was painted before.
  if (data.call !== 'tile') while (lines.length) work();
  try {
    const answer = await calls[data.call](data);
    const buffers = [answer?.bytes?.buffer, answer?.values?.buffer, ArrayBuffer.isView(answer) ? answer.buffer : null];
    post({id: data.id, answer}, buffers.filter(b => b));
  } catch (error) {
    post({id: data.id, error: error.message});
  }
};
