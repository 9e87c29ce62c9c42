// web_browser.mjs: what a painter waits for in the web application, in a browser, by the clock: the first stroke, a painting that is
// opened again; and memory. Usage: node bench/web_browser.mjs [APP_FOLDER] [MEGAPIXELS]   (build/web/app, 8)
import {Browser} from './browser.mjs';

const [app = 'build/web/app', megapixels = '8'] = process.argv.slice(2);
const print = (name, value) => console.log(`${name.padEnd(48)} ${value}`);
const seconds = ms => `${(ms / 1000).toFixed(2)} s`, megabytes = bytes => `${(bytes / 1e6).toFixed(0)} MB`;

// ---- In the page
// A new painting as the dialog offers it, from the tap on Begin until a stroke can be painted and the canvas is seen.
async function begins() {
  const from = performance.now();
  await tangipaint.create({title: 'First', choice: {substrate: 'linen', width_mm: 240, height_mm: 180, pixel_mm: 240 / 1400, seed: 1}, picture: null, relief: null});
  const possible = performance.now() - from;
  while (document.documentElement.dataset.drawn !== 'whole') await new Promise(resolve => setTimeout(resolve, 5));
  return {possible, seen: performance.now() - from};
}
// Strokes of four paints, 11 to 61 pixels wide and 0.2 to 0.6 of the canvas long, anywhere on it; of the whole application.
async function fill(width, height, strokes) {
  let state = 1;
  const random = (low, high) => low + (high - low) * ((state = state * 48271 % 2147483647) / 2147483647);  // Park, Miller 1988
  const mm = 0.1, lines = [JSON.stringify({format: 'tangipaint strokes', version: 1})], paints = ['Titanium White', 'Ultramarine Blue', 'Bone Black', 'Diarylide Yellow'];
  for (let i = 0; i < strokes; ++i) {
    const x = random(-0.5, 0.5) * width, y = random(-0.5, 0.5) * height, long = random(0.2, 0.6) * width, angle = random(0, 2 * Math.PI);
    lines.push(JSON.stringify({event: 'stroke', brush: {preset: i % 2 ? 'flat' : 'round', size_mm: random(11, 61) * mm}, paint: {[paints[i % 4]]: 1}, seed: i}));
    for (let k = 0; k <= 10; ++k)
      lines.push(JSON.stringify({event: 'point', t: k / 10, x: (x + long * (k / 10 - 0.5) * Math.cos(angle)) * mm, y: (y + long * (k / 10 - 0.5) * Math.sin(angle)) * mm, p: 0.6}));
    lines.push('{"event":"end"}');
  }
  const from = performance.now();
  await tangipaint.create({title: 'Filled', choice: {substrate: 'linen', width_mm: width * mm, height_mm: height * mm, pixel_mm: mm, seed: 1}, picture: null, relief: null,
    journal: new File([`${lines.join('\n')}\n`], 'strokes.jsonl')});
  if (!tangipaint.open) throw new Error(document.getElementById('asked').textContent);
  while (document.documentElement.dataset.drawn !== 'whole') await new Promise(resolve => setTimeout(resolve, 20));
  return {...await tangipaint.connection.ask('totals'), ms: performance.now() - from};
}
// Keeps the engine's memory, as when the painter leaves.
async function keeps() {
  const from = performance.now(), {work} = tangipaint.open;
  const kept = await tangipaint.connection.ask('keep', {work: work.record.id, next: work.next, worth: 0}), {usageDetails} = await navigator.storage.estimate();
  if (!kept) throw new Error('the memory was not kept');
  return {ms: performance.now() - from, bytes: usageDetails?.fileSystem ?? NaN};
}
// Since the page was asked for, once a stroke can be painted; what is on the graphics device: tiles, and pages of their places.
function opened() {
  const {tiles, horizon} = tangipaint.open.view.drawing, megabyte = 2 ** 20;
  return {ms: performance.now(), again: tangipaint.open.again, graphics: tiles.layers * megabyte + tiles.table.length * 2 + (horizon ? 384 * 384 * 16 : 0)};
}
// What is on the easel as a painting file, and a work on it that is opened by its address.
async function onItsFile() {
  const picture = await tangipaint.connection.ask('file', {original: null});
  const {id} = await tangipaint.storage.begin({title: 'On a file', choice: {painting: true, name: 'painting.exr'}, picture});
  location.hash = id;
  return picture.size;
}

// ---- What it says
async function inBrowser(work) {
  const browser = await Browser.start(app);
  try {
    await browser.open();
    await work(browser);
  } finally {
    await browser.close();
  }
}
await inBrowser(async browser => {
  const ready = await browser.run(() => performance.now());
  const {possible, seen} = await browser.run(begins);
  print('from the address to the gallery', seconds(ready));
  print('from Begin to where a stroke can be painted', seconds(possible));
  print('… and the canvas is seen', seconds(seen));
});
function tellMemory(browser, engine) {
  const {now, most} = browser.memory();
  print('… memory of the engine; of the page, now and at most', `${megabytes(engine)}; ${megabytes(now)}, ${megabytes(most)}`);
}
async function reopens(browser, words) {
  await browser.call('Page.reload');
  await browser.until(() => Boolean(window.tangipaint?.open?.view) && document.getElementById('busy').hidden);
  const {ms, again, graphics} = await browser.run(opened);
  print(words, `${seconds(ms)}, ${again} strokes painted again`);
  print('… textures', megabytes(graphics));
}
const side = Math.sqrt(Number(megapixels) * 1e6 / 12);
for (const [width, height] of [[2048, 1536], [Math.round(4 * side), Math.round(3 * side)]])
  await inBrowser(async browser => {
    const {memory, ms} = await browser.run(fill, width, height, 200);
    print(`${width} x ${height}, 200 strokes, painted in`, seconds(ms));
    tellMemory(browser, memory);
    const kept = await browser.run(keeps);
    print('… its memory kept in', `${seconds(kept.ms)}, ${megabytes(kept.bytes)}`);
    await reopens(browser, '… from the address to where a stroke can be painted');
    const file = await browser.run(onItsFile);
    await reopens(browser, `… the same on its painting file of ${megabytes(file)}`);
    for (let i = 0; i < 30; ++i)
      await browser.call('Input.dispatchMouseEvent', {type: i === 0 ? 'mousePressed' : i < 29 ? 'mouseMoved' : 'mouseReleased', x: 300 + 12 * i, y: 300 + 5 * i, button: 'left', buttons: 1, clickCount: 1});
    await browser.until(() => document.documentElement.dataset.waiting === '0' && tangipaint.open.work.next === 1 && tangipaint.open.work.unstored === 0);
    tellMemory(browser, (await browser.run(() => tangipaint.connection.ask('totals'))).memory);
    print('… painted on; its memory kept in', seconds((await browser.run(keeps)).ms));
    await reopens(browser, '… from the address to where a stroke can be painted');
  });
