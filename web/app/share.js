// share.js: what a painter takes along: a picture, layers, the journal: saved as a file, or given to another app.

import {zip} from './zip.js';

const bytesOf = async blob => new Uint8Array(await blob.arrayBuffer());
const escaped = text => text.replace(/[<>&"']/g, c => `&#${c.charCodeAt(0)};`);

export async function pngOf({width, height, bytes}) {
  const canvas = Object.assign(document.createElement('canvas'), {width, height});
  canvas.getContext('2d').putImageData(new ImageData(new Uint8ClampedArray(bytes.buffer, bytes.byteOffset, bytes.length), width, height), 0, 0);
  return new Promise(resolve => canvas.toBlob(resolve, 'image/png'));
}
// OpenRaster (version 0.0.5): layers from the bottom up, with a thumbnail and the picture of all.
export async function openRaster(layers, whole, thumbnail) {
  const files = [['mimetype', new TextEncoder().encode('image/openraster')]], {width, height} = layers[0];
  const rows = [];
  for (const [i, layer] of layers.entries()) {
    files.push([`data/layer${i}.png`, await bytesOf(await pngOf(layer))]);
    rows.unshift(`<layer name="${escaped(layer.name)}" src="data/layer${i}.png" x="0" y="0" opacity="1.0" composite-op="svg:src-over"/>`);
  }
  const stack = `<?xml version="1.0" encoding="UTF-8"?>\n<image version="0.0.5" w="${width}" h="${height}"><stack>${rows.join('')}</stack></image>\n`;
  files.splice(1, 0, ['stack.xml', new TextEncoder().encode(stack)]);
  files.push(['mergedimage.png', await bytesOf(whole)], ['Thumbnails/thumbnail.png', await bytesOf(thumbnail)]);
  return zip(files, 'image/openraster');
}

export const fileName = (title, ending) => `${title.trim().replace(/[\\/:*?"<>|\u0000-\u001f]+/g, ' ').slice(0, 80) || 'painting'}.${ending}`;

export function download(blob, name) {
  const link = Object.assign(document.createElement('a'), {href: URL.createObjectURL(blob), download: name});
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}
export const canShare = (blob, name) => Boolean(navigator.canShare?.({files: [new File([blob], name, {type: blob.type})]}));
// To another app that the painter chooses; as a file where the browser would not, as where it took too long since the tap.
export async function share(blob, name, title) {
  try {
    await navigator.share({files: [new File([blob], name, {type: blob.type})], title});
  } catch (error) {
    if (error.name !== 'AbortError') download(blob, name);  // AbortError: the painter thought better of it
  }
}
