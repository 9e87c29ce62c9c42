// new_painting.js: what a new painting is painted on: a support, its size, or a picture.

import {at, button, choice, element} from './controls.js';

const supports = [['canvas', 'Canvas'], ['linen', 'Linen'], ['burlap', 'Burlap'], ['panel', 'Panel'], ['gesso', 'Gesso'], ['paper', 'Paper'], ['picture', 'A picture']];
const sizes = [['160', '16 × 12 cm'], ['240', '24 × 18 cm'], ['400', '40 × 30 cm']];
const fineness = [['800', 'Quick'], ['1400', 'Fine'], ['2048', 'Finest']];

// Promises {title, choice, picture, relief, journal} (Blobs), or null.
export function askForPainting(count) {
  const dialog = at('new'), chosen = {support: 'linen', width: '240', pixels: '1400', upright: 'false', height: 'luminance'};
  return new Promise(resolve => {
    const title = element('input', {type: 'text', value: `Painting ${count + 1}`, maxLength: 80});
    const grid = element('div', {className: 'tools', role: 'group', 'aria-label': 'Support'}), pictures = element('div');
    const picture = element('input', {type: 'file', accept: 'image/png,image/jpeg,image/webp,image/avif,.exr'}), relief = element('input', {type: 'file', accept: 'image/png'}), journal = element('input', {type: 'file', accept: '.jsonl,application/x-ndjson'});
    const marked = () => {
      for (const each of grid.children) each.setAttribute('aria-pressed', each.dataset.name === chosen.support);
      pictures.hidden = chosen.support !== 'picture';
      begin.disabled = chosen.support === 'picture' && !picture.files.length;
    };
    for (const [name, label] of supports)
      grid.append(element('button', {type: 'button', textContent: label, 'data-name': name, 'aria-pressed': 'false', onclick: () => { chosen.support = name; marked(); }}));
    const finish = value => {
      dialog.close();
      resolve(value);
    };
    const begin = button('Begin', () => finish({...result(title.value, chosen, picture.files[0], relief.files[0]), journal: journal.files[0] ?? null}), {className: 'button first'});
    picture.onchange = marked;
    pictures.append(element('label', {className: 'field'}, 'Picture, or a fitted painting (.exr)', picture), element('h3', {textContent: 'Relief'}),
      choice('Relief', [['luminance', 'From brightness'], ['none', 'Flat'], ['picture', 'Height map']], chosen.height, v => { chosen.height = v; map.hidden = v !== 'picture'; }));
    const map = element('label', {className: 'field', hidden: true}, 'Height map (PNG, bright is high)', relief);
    pictures.append(map);
    dialog.replaceChildren(element('h2', {id: 'new-title', textContent: 'New painting'}), element('label', {className: 'field'}, 'Title', title),
      element('h3', {textContent: 'Painted on'}), grid, pictures,
      element('h3', {textContent: 'Size'}), choice('Size', sizes, chosen.width, v => { chosen.width = v; }),
      element('div', {style: 'height:8px'}), choice('Format', [['false', 'Landscape'], ['true', 'Portrait']], chosen.upright, v => { chosen.upright = v; }),
      element('h3', {textContent: 'Detail'}), choice('Detail', fineness, chosen.pixels, v => { chosen.pixels = v; }),
      element('label', {className: 'field'}, 'Begin with a journal (.jsonl, optional)', journal),
      element('div', {className: 'ends'}, button('Cancel', () => finish(null)), begin));
    dialog.oncancel = () => resolve(null);
    marked();
    dialog.showModal();
    grid.querySelector('[aria-pressed="true"]').focus();  // and not the title: a keyboard would come up
  });
}

function result(title, chosen, picture, relief) {
  const long = Number(chosen.width), short = long * 3 / 4, upright = chosen.upright === 'true', pixel = long / Number(chosen.pixels);
  const seed = crypto.getRandomValues(new Uint32Array(1))[0] % 100000;
  const piece = {substrate: chosen.support, width_mm: upright ? short : long, height_mm: upright ? long : short, pixel_mm: pixel, seed};
  if (chosen.support !== 'picture') return {title: title.trim() || 'Untitled', choice: piece, picture: null, relief: null};
  if (/\.exr$/i.test(picture.name)) return {title: title.trim() || 'Untitled', choice: {painting: true, name: picture.name}, picture, relief: null};
  const from = chosen.height === 'picture' && !relief ? 'luminance' : chosen.height;
  return {title: title.trim() || 'Untitled', picture, relief: from === 'picture' ? relief : null,
    choice: {picture: true, name: picture.name, long_mm: long, most_pixels: Number(chosen.pixels), height_from: from}};
}

// A picture as the engine wants it, `most` pixels long at most (Infinity: one that pngOf() made, bit for bit): {width, height, bytes:
// RGBA}. With `size`, of so many pixels.
export async function decoded(blob, most, size = null) {
  const bitmap = await createImageBitmap(blob, {colorSpaceConversion: most === Infinity ? 'none' : 'default'}), scale = Math.min(1, most / Math.max(bitmap.width, bitmap.height));
  const width = size?.width ?? Math.max(8, Math.round(bitmap.width * scale)), height = size?.height ?? Math.max(8, Math.round(bitmap.height * scale));
  const context = Object.assign(document.createElement('canvas'), {width, height}).getContext('2d', {willReadFrequently: true});
  context.drawImage(bitmap, 0, 0, width, height);
  bitmap.close();
  return {width, height, bytes: new Uint8Array(context.getImageData(0, 0, width, height).data.buffer)};
}
