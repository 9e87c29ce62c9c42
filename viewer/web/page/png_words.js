// png_words.js: what a PNG says of itself, in chunks of text that other programs show (ISO/IEC 15948, 11.3.4).

const crcTable = Uint32Array.from({length: 256}, (_, n) => {
  for (let k = 0; k < 8; ++k) n = n & 1 ? 0xedb88320 ^ n >>> 1 : n >>> 1;
  return n;
});
// Of PNG and ZIP alike.
export function crc32(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) crc = crcTable[(crc ^ byte) & 255] ^ crc >>> 8;
  return (crc ^ 0xffffffff) >>> 0;
}

const behindHeader = 33;  // signature and IHDR, which comes first

// iTXt, not compressed, of no language: its length, its type and content, and the sum over these.
function textChunk(keyword, text) {
  const content = new TextEncoder().encode(`iTXt${keyword}\0\0\0\0\0${text}`), chunk = new Uint8Array(content.length + 8), view = new DataView(chunk.buffer);
  view.setUint32(0, content.length - 4);
  chunk.set(content, 4);
  view.setUint32(content.length + 4, crc32(content));
  return chunk;
}

// How it is lit, of a page's or the application's state.
export const lightWords = ({looks}, {light: {azimuth, elevation}, look}) => `${looks[look].name}, lit from ${Math.round((azimuth + 360) % 360)}°, ${Math.round(elevation)}° high`;

// png: a Blob. words: {Title, Author, Copyright, …}, as the standard calls them; what is empty is left out. Gives a Blob with them.
export function withWords(png, words) {
  const chunks = Object.entries(words).filter(([, text]) => text).map(([keyword, text]) => textChunk(keyword, text));
  return new Blob([png.slice(0, behindHeader), ...chunks, png.slice(behindHeader)], {type: png.type});
}
