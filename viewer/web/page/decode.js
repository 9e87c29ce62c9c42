// decode.js: from a part as it is sent to numbers (viewer/web/web_tiles.h, lossy_tiles.h).

const bytesOfText = text => Uint8Array.from(atob(text), c => c.charCodeAt(0));
async function inflatedBytes(packed) {
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Adds these fields of a tile without losses to its words, four a texel.
function unpackFields(fields, bytes, width, height, words) {
  const count = width * height, codes = new Int32Array(count);
  let low = 0;
  for (const {word, shift, bits, kept} of fields) {
    const high = kept > 8 ? low + count : 0, mask = 2 ** kept - 1, wider = (2 ** bits - 1) / mask;
    for (let y = 0, i = 0; y < height; ++y)
      for (let x = 0; x < width; ++x, ++i) {
        const folded = bytes[low + i] | (high ? bytes[high + i] << 8 : 0);
        const rest = folded & 1 ? -((folded + 1) >> 1) : folded >> 1;
        const left = x > 0 ? codes[i - 1] : y > 0 ? codes[i - width] : 0, up = y > 0 ? codes[i - width] : left;
        const corner = x > 0 && y > 0 ? codes[i - width - 1] : up;
        const least = Math.min(left, up), most = Math.max(left, up);
        const predicted = corner >= most ? least : corner <= least ? most : left + up - corner;
        codes[i] = (predicted + rest) & mask;
        words[4 * i + word] |= Math.round(codes[i] * wider) << shift;
      }
    low += (kept > 8 ? 2 : 1) * count;
  }
}

// The numbers of a JPEG picture, four a pixel. Some browsers falsify what is read of a canvas, to hide who reads it: then what is
// drawn comes back as something else.
async function pixelsOfJpeg(bytes) {
  const picture = await createImageBitmap(new Blob([bytes], {type: 'image/jpeg'}), {colorSpaceConversion: 'none', premultiplyAlpha: 'none'});
  const {width, height} = picture, canvas = typeof OffscreenCanvas === 'undefined' ? document.createElement('canvas') : new OffscreenCanvas(width, height);
  Object.assign(canvas, {width, height});
  const context = canvas.getContext('2d', {willReadFrequently: true});
  context.fillStyle = '#407fc1';
  context.fillRect(0, 0, 1, 1);
  if ([64, 127, 193].some((v, i) => Math.abs(context.getImageData(0, 0, 1, 1).data[i] - v) > 2))
    throw new Error('this browser falsifies the pictures that pages read; allow this page to read canvases');
  context.drawImage(picture, 0, 0);
  picture.close();
  return context.getImageData(0, 0, width, height).data;
}

async function lossyTile(fields, bytes, width, height) {
  const view = new DataView(bytes.buffer, bytes.byteOffset), words = new Uint32Array(4 * width * height), of = packing => fields.filter(f => f.packing === packing);
  let at = 0;
  const number = () => view.getUint32((at += 4) - 4, true), piece = () => {
    const size = number();
    return bytes.subarray(at, at += size);
  };
  const greys = of('grey').map(field => ({...field, low: number(), high: number()}));
  const colour = await pixelsOfJpeg(piece()), grey = await pixelsOfJpeg(piece()), exact = piece(), rows = 8 * Math.ceil(height / 8);
  of('colour').forEach(({word, shift, bits}, k) => {
    for (let i = 0; i < width * height; ++i) words[4 * i + word] |= Math.round(colour[4 * i + k] / 255 * (2 ** bits - 1)) << shift;
  });
  greys.forEach(({word, shift, low, high}, k) => {
    for (let i = 0, from = 4 * k * rows * width; i < width * height; ++i, from += 4) words[4 * i + word] |= low + Math.round(grey[from] / 255 * (high - low)) << shift;
  });
  if (exact.length) unpackFields(of('exact'), await inflatedBytes(exact), width, height, words);
  return words;
}

// A part: its text, and what it is: a tile {fields, width, height}, or else the map of horizons; whether it is packed with losses.
async function decodedPart({text, tile, lossy}) {
  const packed = bytesOfText(text);
  if (tile && lossy) return lossyTile(tile.fields, packed, tile.width, tile.height);
  if (tile) {
    const words = new Uint32Array(4 * tile.width * tile.height);
    unpackFields(tile.fields, await inflatedBytes(packed), tile.width, tile.height, words);
    return words;
  }
  if (lossy) return new Uint8Array(await pixelsOfJpeg(packed)).filter((_, i) => i % 4 === 0);
  const values = await inflatedBytes(packed);
  for (let i = 1; i < values.length; ++i) values[i] += values[i - 1];  // each is less its left neighbour
  return values;
}

// Decodes pictures in a worker, whose script is what is above. What has no losses takes a few milliseconds a tile, and is unpacked
// at once.
export class Decoder {
  constructor() { Object.assign(this, {waiting: new Map(), asked: 0, worker: undefined}); }
  start() {
    const script = `const bytesOfText = ${bytesOfText};\n${[inflatedBytes, unpackFields, pixelsOfJpeg, lossyTile, decodedPart].join('\n')}
      onmessage = ({data: {id, job}}) => decodedPart(job).then(result => postMessage({id, result}, [result.buffer]), error => postMessage({id, error: error.message}));`;
    try {
      this.worker = new Worker(URL.createObjectURL(new Blob([script], {type: 'text/javascript'})));
      this.worker.onmessage = ({data}) => this.take(data);
      this.worker.onerror = () => this.alone();
    } catch {
      this.worker = null;  // a site may forbid it
    }
  }
  decode(job) {
    if (job.lossy && this.worker === undefined) this.start();
    if (!job.lossy || !this.worker) return decodedPart(job);
    return new Promise((resolve, reject) => {
      this.waiting.set(++this.asked, {job, resolve, reject});
      this.worker.postMessage({id: this.asked, job});
    });
  }
  take({id, result, error}) {
    const {resolve, reject} = this.waiting.get(id) ?? {};
    this.waiting.delete(id);
    if (error) reject?.(new Error(error));
    else resolve?.(result);
  }
  // Without the worker: what it was asked for is done here.
  alone() {
    this.worker = null;
    for (const {job, resolve, reject} of this.waiting.values()) decodedPart(job).then(resolve, reject);
    this.waiting.clear();
  }
}
