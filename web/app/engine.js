// engine.js: the engine as calls of JavaScript: one painting at work, in WebAssembly (web/platform/binding.cpp).

export class EngineError extends Error {}

// [bytes] What a painting may take of the device's memory: browsers tell of it in powers of two, up to 8 GB, or not at all. Of 4
// GB a third, so that the system does not close the page; of more, what 32 bits can name, less room for strokes and undo.
const memoryBytes = Math.min((globalThis.navigator?.deviceMemory ?? 4) * 0.35, 3) * 2 ** 30;

// Addresses come as 32 bits with a sign: beyond 2 GB they would be negative.
const placeOf = address => address >>> 0;

export class Engine {
  // calls: how many there were; between two of them nothing changes.
  constructor(module) { Object.assign(this, {module, calls: 0}); }
  // `make`: the default export of engine.mjs.
  static async load(make) { return new Engine(await make()); }

  // Where a text, or bytes, are in the engine's memory; to be freed.
  copied(value) {
    const {module} = this, text = typeof value === 'string', size = text ? module.lengthBytesUTF8(value) + 1 : value.length, at = placeOf(module._malloc(size));
    if (!at) throw new EngineError('there is not enough memory for this');
    if (text) module.stringToUTF8(value, at, size);
    else module.HEAPU8.set(value, at);
    return at;
  }
  // Calls a function of the binding with numbers, texts and bytes (Uint8Array); throws EngineError with its words.
  call(name, ...values) {
    const {module} = this, taken = [];
    ++this.calls;
    const given = values.map(value => {
      if (typeof value === 'number') return value;
      taken.push(this.copied(value));
      return taken.at(-1);
    });
    try {
      const done = module[`_tp_${name}`](...given), text = module.UTF8ToString(placeOf(module._tp_text()));
      if (!done) throw new EngineError(text);
      return text;
    } finally {
      for (const at of taken) module._free(at);
    }
  }
  json(name, ...values) {
    const text = this.call(name, ...values);
    return text ? JSON.parse(text) : null;
  }
  // The bytes of the last answer, in memory of their own.
  bytes() {
    const {module} = this, at = placeOf(module._tp_bytes());
    return module.HEAPU8.slice(at, at + module._tp_byte_count());
  }

  // choice: web/engine/ground.h; pictures: {width, height, bytes: RGBA}.
  open(choice, picture, relief) { return this.onGround('open', choice, picture, relief); }
  // The same painting on another ground of the same relief.
  lieOn(choice, picture, relief) { return this.onGround('lie_on', choice, picture, relief); }
  onGround(call, choice, ...pictures) {
    const parts = pictures.flatMap(p => [p?.bytes ?? new Uint8Array(1), p?.width ?? 0, p?.height ?? 0]);
    return this.json(call, JSON.stringify({memory_bytes: memoryBytes, ...choice}), ...parts);
  }
  // file: a painting file (web/engine/painting_bytes.h), {size, read(at, count) -> Uint8Array}: a part at a time is in memory.
  openPainting(file, undoBytes = 128 * 2 ** 20) {
    this.reads(file);
    try {
      return this.json('open_painting', file.size, memoryBytes, undoBytes);
    } finally {
      this.reads(null);
    }
  }
  // From where the binding has bytes of a file (read_file()).
  reads(file) {
    const {module} = this;
    module.readFile = file && ((at, to, count) => {
      try {
        module.HEAPU8.set(file.read(at, count), placeOf(to));
        return 1;
      } catch (error) {
        console.warn(error);
        return 0;
      }
    });
  }
  // What is on the easel as a painting file (painting_file.js): {blocks}; its head is in bytes(). original: the file that it is painted
  // on, as openPainting() has it, or null; it is read until endFile().
  beginFile(original) {
    this.reads(original);
    return this.json('begin_file', original?.size ?? 0);
  }
  fileBlock(number, sorted) { return this.json('file_block', number, sorted ? 1 : 0); }
  endFile() {
    this.call('end_file');
    this.reads(null);
  }
  begin(firstLine) { this.call('begin', firstLine); }
  apply(line) { return this.call('apply', line); }
  // [{x0, y0, x1, y1}, …] of the painting's pixels that look different now.
  refresh(all) { return this.json('refresh', all ? 1 : 0).map(([x0, y0, x1, y1]) => ({x0, y0, x1, y1})); }
  texels(level, {x0, y0, x1, y1}) {
    this.call('texels', level, x0, y0, x1, y1);
    return new Uint32Array(this.bytes().buffer);
  }
  // {width, height, x, y, columns, rows, bytes: RGBA}, or null where nothing has changed.
  picture(name, ...values) {
    const place = this.json(name, ...values);
    return place && {...place, bytes: this.bytes()};
  }
  // All that it knows, between two calls: its memory, of at least so many bytes. What is written there it is from then on.
  memory(bytes = 0) {
    const {module} = this;
    while (module.HEAPU8.length < bytes) if (!module._malloc(bytes - module.HEAPU8.length)) throw new EngineError('there is not enough memory for this');
    return module.HEAPU8;
  }
}
