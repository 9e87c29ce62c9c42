// zip.js: a ZIP archive of files that are stored as they are (PKWARE APPNOTE 6.3.3), as OpenRaster wants it.

import {crc32} from './shared/png_words.js';

// Little-endian numbers: [value, bytes], …
function packed(...fields) {
  const view = new DataView(new ArrayBuffer(fields.reduce((sum, [, size]) => sum + size, 0)));
  let at = 0;
  for (const [value, size] of fields) {
    if (size === 2) view.setUint16(at, value, true);
    else view.setUint32(at, value, true);
    at += size;
  }
  return new Uint8Array(view.buffer);
}

// files: [[name, Uint8Array], …] in this order. Names are UTF-8.
export function zip(files, type) {
  const parts = [], entries = [];
  let offset = 0;
  const put = bytes => {
    parts.push(bytes);
    offset += bytes.length;
  };
  for (const [name, bytes] of files) {
    const path = new TextEncoder().encode(name), [utf8, stored, time, day] = [0x0800, 0, 0, 0x21];
    const common = [[20, 2], [utf8, 2], [stored, 2], [time, 2], [day, 2], [crc32(bytes), 4], [bytes.length, 4], [bytes.length, 4], [path.length, 2], [0, 2]];
    entries.push([packed([0x02014b50, 4], [20, 2], ...common, [0, 2], [0, 2], [0, 2], [0, 4], [offset, 4]), path]);
    for (const piece of [packed([0x04034b50, 4], ...common), path, bytes]) put(piece);
  }
  const begin = offset;
  for (const piece of entries.flat()) put(piece);
  put(packed([0x06054b50, 4], [0, 2], [0, 2], [files.length, 2], [files.length, 2], [offset - begin, 4], [begin, 4], [0, 2]));
  return new Blob(parts, {type});
}
