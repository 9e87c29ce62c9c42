// parts.js: parts of an exported page, fetched and decoded.

import {Decoder} from './decode.js';

// Parts of the page: inside it, or scripts beside it that call this. Two states may ask for the same at once.
const arriving = new Map();
window.tangiPart = (name, text) => arriving.get(name)?.resolve(text);
function textOfPart(name) {
  const inside = document.getElementById(`part-${name}`);
  if (inside) return Promise.resolve(inside.textContent);
  if (!arriving.has(name)) arriving.set(name, scriptOfPart(name));
  return arriving.get(name).promise;
}
function scriptOfPart(name) {
  const script = document.createElement('script'), asked = {};
  asked.promise = new Promise((resolve, reject) => {
    asked.resolve = resolve;
    script.onload = script.onerror = () => reject(new Error(`parts/${name}.js cannot be loaded`));
  }).finally(() => {
    script.remove();
    arriving.delete(name);
  });
  script.src = `parts/${name}.js`;
  document.head.append(script);
  return asked;
}

const decoder = new Decoder();
// The map of horizons that is in a part; a tile, as Tiles wants it, of the part that nameOf(its name) says.
export const horizonOf = async (name, lossy) => decoder.decode({text: await textOfPart(name), lossy});
export const fetchTile = (fields, lossy, nameOf) => async ({name}, width, height) =>
  decoder.decode({text: await textOfPart(nameOf(name)), tile: {fields, width, height}, lossy});
