// painting_file.js: what is on the easel as a painting file (web/engine/painting_bytes.h), packed by the browser.

// What zlib makes of bytes (RFC 1950).
async function packed(bytes) {
  return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(new CompressionStream('deflate'))).arrayBuffer());
}

// A Blob as the engine reads it (Engine.openPainting()), in a worker. told(part): how far that is, 0 to 1.
export function partsOf(blob, told = () => {}) {
  const reader = new FileReaderSync();
  return {size: blob.size, read(at, count) {
    told(at / blob.size);
    return new Uint8Array(reader.readAsArrayBuffer(blob.slice(at, at + count)));
  }};
}

// `original`: the file that it was painted on, as partsOf() has it, or none. Promises a Blob. told(part): how far it is, 0 to 1.
export async function paintingFile(engine, original, told) {
  try {
    return await written(engine, original, told);
  } finally {
    engine.endFile();
  }
}
async function written(engine, original, told) {
  const {blocks} = engine.beginFile(original), head = engine.bytes(), places = new DataView(new ArrayBuffer(8 * blocks)), parts = [head, places];
  let at = head.length + 8 * blocks;
  for (let i = 0; i < blocks; ++i) {
    const {part, y, packed: done} = engine.fileBlock(i, true);
    let bytes = engine.bytes();
    if (!done) {
      const shorter = await packed(bytes);
      if (shorter.length < bytes.length) {
        bytes = shorter;
      } else {
        engine.fileBlock(i, false);
        bytes = engine.bytes();
      }
    }
    places.setBigUint64(8 * i, BigInt(at), true);
    parts.push(Int32Array.of(part, y, bytes.length), bytes);
    at += 12 + bytes.length;
    told(i / blocks);
  }
  return new Blob(parts, {type: 'image/x-exr'});
}
