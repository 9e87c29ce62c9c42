// painting_sheet.js: the painting as a whole: its layers, its ground, and what is taken along of it.

import {ask, busy, button, choice, element, notice, slider} from './controls.js';
import {lightWords, withWords} from './shared/png_words.js';
import {canShare, download, fileName, openRaster, pngOf, share} from './share.js';

let shares = false;  // what is taken along goes to another app, not into a file

// open: {work, view, connection, state}; apply(event); reground(choice): the same painting on a ground that looks otherwise.
export function fillPaintingSheet(sheet, {open, apply, rename, reground}) {
  const {work, state} = open, layers = element('ul', {id: 'layers', 'aria-label': 'Dried layers'});
  for (const name of [...state.layers].reverse())
    layers.append(element('li', {}, element('span', {textContent: name}), button('Remove', async () => {
      if (await ask(`Remove “${name}”?`, 'The dried paint of this layer comes off. Undo brings it back.', [[null, 'Keep'], [true, 'Remove', 'danger']])) apply({event: 'lift', layer: name});
    }, {'aria-label': `Remove layer ${name}`, className: 'button danger'})));
  const title = element('input', {type: 'text', value: work.record.title, maxLength: 80, 'aria-label': 'Title', onchange: () => rename(title.value)});
  sheet.append(title, element('h3', {textContent: 'Paint'}),
    button('Let everything dry', () => apply({event: 'dry', layer: `layer ${state.layers.length + 1}`}), {className: 'button wide', disabled: !state.wet}),
    element('p', {className: 'hint', textContent: 'Dry paint is no longer smeared: what is painted next lies over it.'}));
  if (state.layers.length) sheet.append(layers);
  ground(sheet, work, reground);
  sheet.append(element('h3', {textContent: 'Take along'}));
  if (canShare(new Blob([], {type: 'image/png'}), 'painting.png'))
    sheet.append(choice('Take along', [['false', 'As a file'], ['true', 'To another app']], String(shares), v => { shares = v === 'true'; }), element('div', {style: 'height:8px'}));
  sheet.append(element('div', {className: 'row'}, button('Picture', () => takePicture(open)), button('Layers (OpenRaster)', () => takeLayers(open)),
    button('Painting file (.exr)', () => takePainting(open)), button('Journal', () => takeJournal(open))),
  element('p', {className: 'hint', textContent: 'The journal paints the same on a desktop, bit for bit: “tangipaint replay”. The painting file has all layers of paint, and opens there and here.'}));
}

// How the ground looks: as it is made, but for what is set here.
function ground(sheet, {record}, reground) {
  const {choice} = record;
  if (choice.painting) return;  // it is as it was measured
  const of = (label, value, {from, to, digits, logarithmic}, finish) => {
    let set = value;
    return slider({label, from, to, value, words: v => v.toFixed(digits), changed: v => { set = v; }, settled: () => reground({...record.choice, ...finish(set)}), logarithmic});
  };
  sheet.append(element('h3', {textContent: 'Ground'}),
    of('Tone ρd', choice.tint?.[0] ?? 1, {from: 0.1, to: 1, digits: 2}, v => ({tint: [v, v, v]})),
    of('Gloss ρs', choice.specular ?? 0.02, {from: 0, to: 0.2, digits: 3}, specular => ({specular})),
    of('Roughness α', choice.roughness ?? 0.35, {from: 0.02, to: 0.8, digits: 2, logarithmic: true}, roughness => ({roughness})));
}

// Saves what `make` promises as a file called after the painting, or gives it to another app.
async function taken(open, words, ending, make) {
  const {title} = open.work.record, name = fileName(title, ending);
  busy(words);
  try {
    const blob = await make();
    if (shares && canShare(blob, name)) await share(blob, name, title);
    else download(blob, name);
  } catch (error) {
    notice(`That did not work: ${error.message}`, true);
  } finally {
    busy(null);
  }
}
const takePicture = open => taken(open, 'Drawing the picture…', 'png', async () => {
  const {view: {picture, state}, work: {record}} = open;
  return withWords(await open.view.snapshot(), {Title: record.title, Description: lightWords(picture, state), Software: picture.software});
});
const takeLayers = open => taken(open, 'Packing the layers…', 'ora', async () => {
  const layers = await open.connection.ask('layers'), whole = await open.view.snapshot();
  return openRaster(layers, whole, await pngOf(await open.connection.ask('thumbnail', {size: 256})));
});
const takePainting = open => taken(open, 'Writing the painting file…', 'exr', async () => {
  return open.connection.ask('file', {original: await open.work.original()});
});
const takeJournal = open => taken(open, 'Writing the journal…', 'jsonl', async () => new Blob([await open.work.text()], {type: 'application/x-ndjson'}));
// What a full or failing storage has not taken can still be saved by hand.
export async function rescue(work) {
  download(new Blob([await work.text()], {type: 'application/x-ndjson'}), fileName(work.record.title, 'jsonl'));
}
