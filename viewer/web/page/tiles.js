// tiles.js: the painting's texels on the graphics device, as far as they are seen: fetched, unpacked
// (viewer/web/web_tiles.h), kept in the layers of one texture of bounded size.

// Parts of the page: inside it, or scripts beside it that call this.
const arriving = new Map();
window.tangiPart = (name, text) => {
  arriving.get(name)?.(text);
  arriving.delete(name);
};
function textOfPart(name) {
  const inside = document.getElementById(`part-${name}`);
  if (inside) return Promise.resolve(inside.textContent);
  return new Promise((resolve, reject) => {
    const script = document.createElement('script');
    arriving.set(name, resolve);
    script.src = `parts/${name}.js`;
    script.onload = () => script.remove();
    script.onerror = () => {
      script.remove();
      arriving.delete(name);
      reject(new Error(`parts/${name}.js cannot be loaded`));
    };
    document.head.append(script);
  });
}
async function part(name) {
  const packed = Uint8Array.from(atob(await textOfPart(name)), c => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

function unpackTile(bytes, width, height) {
  const count = width * height, words = new Uint32Array(4 * count), codes = new Int32Array(count);
  let low = 0;
  for (const {word, shift, bits, kept} of data.fields) {
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
  return words;
}

const tileBits = 8, tileSide = 1 << tileBits, stripSide = 16, tableWidth = 1024, fetchesAtOnce = 6, secondsToRetry = 5;

class Tiles {
  // `layers`: tiles that are kept. `changed` is called when one has come, `missed` with the name of one that has not.
  constructor(gl, layers, changed, missed) {
    Object.assign(this, {gl, changed, missed, frame: 0, loading: new Set(), failed: new Set(), resident: new Map(), wanted: []});
    let first = 0;
    this.levels = Array.from({length: data.levels}, (_, level) => {
      const width = Math.ceil(data.width / 2 ** level), height = Math.ceil(data.height / 2 ** level);
      const columns = Math.ceil(width / tileSide), rows = Math.ceil(height / tileSide);
      first += columns * rows;
      return {width, height, columns, rows, first: first - columns * rows};
    });
    this.all = first;
    this.layers = Math.min(layers, first, gl.getParameter(gl.MAX_ARRAY_TEXTURE_LAYERS), 2047);
    this.free = Array.from({length: this.layers}, (_, i) => i);
    this.table = new Uint16Array(tableWidth * Math.ceil(first / tableWidth));
    if (gl.getParameter(gl.MAX_TEXTURE_SIZE) < tileSide / stripSide * tileSide) throw new Error('This graphics device is too old.');
    this.texels = this.texture(gl.TEXTURE_2D_ARRAY);
    gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, gl.RGBA32UI, stripSide, tileSide / stripSide * tileSide, this.layers);
    this.pages = this.texture(gl.TEXTURE_2D);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.R16UI, tableWidth, this.table.length / tableWidth);
  }
  texture(target) {
    const {gl} = this, texture = gl.createTexture();
    gl.bindTexture(target, texture);
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(target, name, gl.NEAREST);
    return texture;
  }
  get ready() { return this.resident.has(`${data.levels - 1}/0_0`); }
  get complete() { return this.ready && this.wanted.every(t => this.resident.has(t.name) || this.failed.has(t.name)); }

  range(level, seen) {
    const shift = 2 ** (level + tileBits), {columns, rows} = this.levels[level];
    const last = (v, most) => Math.min(Math.floor(v / shift), most - 1);
    return {x0: Math.floor(seen.x0 / shift), y0: Math.floor(seen.y0 / shift), x1: last(seen.x1, columns), y1: last(seen.y1, rows)};
  }
  count(level, seen) {
    const r = this.range(level, seen);
    return (r.x1 - r.x0 + 1) * (r.y1 - r.y0 + 1);
  }
  // The finest level, from this one on, whose tiles fit into memory together with coarser ones that stand in.
  affordable(level, seen) {
    while (level < data.levels - 1 && this.layers < this.all && this.count(level, seen) * 1.4 + 8 > this.layers) ++level;
    return level;
  }
  // Asks for what views need: [{level, seen}]. Coarse tiles first, then those in the middle.
  want(views) {
    ++this.frame;
    const all = new Map();
    const add = (level, {seen}) => {
      const r = this.range(level, seen), middle = [(r.x0 + r.x1) / 2, (r.y0 + r.y1) / 2];
      for (let y = r.y0; y <= r.y1; ++y)
        for (let x = r.x0; x <= r.x1; ++x) {
          const name = `${level}/${x}_${y}`, tile = this.resident.get(name);
          if (tile) tile.used = this.frame;
          all.set(name, {name, level, x, y, order: -1000 * level + Math.hypot(x - middle[0], y - middle[1])});
        }
    };
    const whole = {seen: {x0: 0, y0: 0, x1: data.width - 1, y1: data.height - 1}};
    add(data.levels - 1, whole);
    for (const view of views)
      for (const level of [view.level + 2, view.level]) if (level < data.levels) add(level, view);
    this.wanted = [...all.values()].sort((a, b) => a.order - b.order);
    this.load();
  }
  load() {
    for (const tile of this.wanted) {
      if (this.loading.size >= fetchesAtOnce) return;
      if (this.resident.has(tile.name) || this.loading.has(tile.name) || this.failed.has(tile.name)) continue;
      this.loading.add(tile.name);
      part(tile.name).then(bytes => this.take(tile, bytes)).catch(error => {
        this.failed.add(tile.name);
        console.warn(error.message);
        this.missed(tile.name);
        setTimeout(() => {
          this.failed.delete(tile.name);
          this.changed();
        }, secondsToRetry * 1000);
      }).finally(() => {
        this.loading.delete(tile.name);
        this.load();
        this.changed();
      });
    }
  }
  take(tile, bytes) {
    const {gl} = this, layer = this.layerFor();
    if (layer === undefined) return;  // the view has changed: everything that is kept is seen
    const size = this.levels[tile.level];
    const width = Math.min(tileSide, size.width - tile.x * tileSide), height = Math.min(tileSide, size.height - tile.y * tileSide);
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.texels);
    const texels = unpackTile(bytes, width, height);
    gl.pixelStorei(gl.UNPACK_ROW_LENGTH, width);
    for (let x = 0; x < width; x += stripSide) {
      gl.pixelStorei(gl.UNPACK_SKIP_PIXELS, x);
      gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, 0, 0, x / stripSide * tileSide, layer, Math.min(stripSide, width - x), height, 1,
        gl.RGBA_INTEGER, gl.UNSIGNED_INT, texels);
    }
    gl.pixelStorei(gl.UNPACK_ROW_LENGTH, 0);
    gl.pixelStorei(gl.UNPACK_SKIP_PIXELS, 0);
    this.resident.set(tile.name, {layer, used: this.frame, level: tile.level, x: tile.x, y: tile.y});
    this.stale = true;
  }
  // A free layer, or that of the tile that has not been seen for longest; the coarsest stays.
  layerFor() {
    if (this.free.length) return this.free.pop();
    let oldest;
    for (const [name, tile] of this.resident)
      if (tile.level < data.levels - 1 && tile.used < this.frame && (!oldest || tile.used < oldest[1].used)) oldest = [name, tile];
    if (!oldest) return undefined;
    this.resident.delete(oldest[0]);
    return oldest[1].layer;
  }
  // For each tile of each level: the layer (11 bits) and level of the finest one there is that covers it.
  bind(textureUnit, pagesUnit) {
    const {gl} = this;
    gl.activeTexture(gl.TEXTURE0 + textureUnit);
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.texels);
    gl.activeTexture(gl.TEXTURE0 + pagesUnit);
    gl.bindTexture(gl.TEXTURE_2D, this.pages);
    if (!this.stale) return;
    this.stale = false;
    const found = new Map();
    for (const tile of this.resident.values()) found.set(this.levels[tile.level].first + tile.y * this.levels[tile.level].columns + tile.x, tile.layer);
    for (let level = data.levels - 1; level >= 0; --level) {
      const {columns, rows, first} = this.levels[level], above = this.levels[level + 1];
      for (let y = 0; y < rows; ++y)
        for (let x = 0; x < columns; ++x) {
          const place = first + y * columns + x, layer = found.get(place);
          this.table[place] = layer !== undefined ? level << 11 | layer : above ? this.table[above.first + (y >> 1) * above.columns + (x >> 1)] : 0;
        }
    }
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 2);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, tableWidth, this.table.length / tableWidth, gl.RED_INTEGER, gl.UNSIGNED_SHORT, this.table);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 4);
  }
}
