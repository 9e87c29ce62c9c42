// tiles.js: the painting's texels on the graphics device, as far as they are seen: kept in the layers of one texture of
// bounded size.

const tileBits = 8, stripSide = 16, tableWidth = 1024, fetchesAtOnce = 6, secondsToRetry = 5;
export const tileSide = 1 << tileBits;

export class Tiles {
  // picture: {width, height, levels}. `layers`: tiles that are kept. `source`: fetch({name, level, x, y}, width, height) promises
  // a tile's texels, four 32-bit words each, row by row; changed() is called when one has come, missed(name) when one has not,
  // left(name), where given, when one is kept no longer.
  constructor(gl, picture, layers, source) {
    Object.assign(this, {gl, picture, source, frame: 0, loading: new Set(), failed: new Set(), resident: new Map(), wanted: []});
    let first = 0;
    this.levels = Array.from({length: this.picture.levels}, (_, level) => {
      const width = Math.ceil(this.picture.width / 2 ** level), height = Math.ceil(this.picture.height / 2 ** level);
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
  get ready() { return this.resident.has(`${this.picture.levels - 1}/0_0`); }
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
    while (level < this.picture.levels - 1 && this.layers < this.all && this.count(level, seen) * 1.4 + 8 > this.layers) ++level;
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
    const whole = {seen: {x0: 0, y0: 0, x1: this.picture.width - 1, y1: this.picture.height - 1}};
    add(this.picture.levels - 1, whole);
    for (const view of views)
      for (const level of [view.level + 2, view.level]) if (level < this.picture.levels) add(level, view);
    this.wanted = [...all.values()].sort((a, b) => a.order - b.order);
    this.load();
  }
  load() {
    for (const tile of this.wanted) {
      if (this.loading.size >= fetchesAtOnce) return;
      if (this.resident.has(tile.name) || this.loading.has(tile.name) || this.failed.has(tile.name)) continue;
      this.loading.add(tile.name);
      const {width, height} = this.sizeOf(tile);
      this.source.fetch(tile, width, height).then(texels => this.take(tile, texels)).catch(error => {
        this.failed.add(tile.name);
        console.warn(error.message);
        this.source.missed(tile.name);
        setTimeout(() => {
          this.failed.delete(tile.name);
          this.source.changed();
        }, secondsToRetry * 1000);
      }).finally(() => {
        this.loading.delete(tile.name);
        this.load();
        this.source.changed();
      });
    }
  }
  sizeOf({level, x, y}) {
    const size = this.levels[level];
    return {width: Math.min(tileSide, size.width - x * tileSide), height: Math.min(tileSide, size.height - y * tileSide)};
  }
  take(tile, texels) {
    const layer = this.layerFor();
    if (layer === undefined) {  // the view has changed: everything that is kept is seen
      this.source.left?.(tile.name);
      return;
    }
    const {width, height} = this.sizeOf(tile);
    this.upload(layer, {x: 0, y: 0, width, height}, texels, 0, width);
    this.resident.set(tile.name, {layer, used: this.frame, level: tile.level, x: tile.x, y: tile.y});
    this.stale = true;
  }
  // Texels of a rectangle of a level that have changed, where tiles of it are kept.
  update(level, {x0, y0, x1, y1}, texels) {
    const width = x1 - x0;
    for (let row = y0 >> tileBits; row <= (y1 - 1) >> tileBits; ++row)
      for (let column = x0 >> tileBits; column <= (x1 - 1) >> tileBits; ++column) {
        const tile = this.resident.get(`${level}/${column}_${row}`);
        if (!tile) continue;
        const left = Math.max(x0, column * tileSide), top = Math.max(y0, row * tileSide);
        const right = Math.min(x1, (column + 1) * tileSide), bottom = Math.min(y1, (row + 1) * tileSide);
        const place = {x: left - column * tileSide, y: top - row * tileSide, width: right - left, height: bottom - top};
        this.upload(tile.layer, place, texels, (top - y0) * width + left - x0, width);
      }
  }
  // A layer holds its tile in strips of 16 columns, one below the other. `texels` has `rowLength` in a row, and begins at `first`.
  upload(layer, {x, y, width, height}, texels, first, rowLength) {
    const {gl} = this;
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.texels);
    gl.pixelStorei(gl.UNPACK_ROW_LENGTH, rowLength);
    for (let from = x; from < x + width;) {
      const strip = Math.floor(from / stripSide), to = Math.min((strip + 1) * stripSide, x + width);
      gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, 0, from - strip * stripSide, strip * tileSide + y, layer, to - from, height, 1,
        gl.RGBA_INTEGER, gl.UNSIGNED_INT, texels, 4 * (first + from - x));
      from = to;
    }
    gl.pixelStorei(gl.UNPACK_ROW_LENGTH, 0);
  }
  // A free layer, or that of the tile that has not been seen for longest; the coarsest stays.
  layerFor() {
    if (this.free.length) return this.free.pop();
    let oldest;
    for (const [name, tile] of this.resident)
      if (tile.level < this.picture.levels - 1 && tile.used < this.frame && (!oldest || tile.used < oldest[1].used)) oldest = [name, tile];
    if (!oldest) return undefined;
    this.resident.delete(oldest[0]);
    this.source.left?.(oldest[0]);
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
    for (let level = this.picture.levels - 1; level >= 0; --level) {
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
