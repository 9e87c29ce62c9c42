// states.js: the states of a painting that a page has, as before and after a treatment, or its layers of paint: each with tiles
// and shadows of its own, of which it shares what is alike with the state before it.

import {Drawing} from './drawing.js';
import {fetchTile, horizonOf} from './parts.js';

export class States {
  // data: of the page; `layers`: of tiles kept of each state; changed() after something has come, missed(name) where it has not.
  constructor(canvas, data, layers, changed, missed) {
    Object.assign(this, {canvas, data, layers, changed, missed, drawings: [], owned: data.states.map(s => new Set(s.own ?? []))});
  }
  picture(k) { return {...this.data, ...this.data.states[k]}; }
  // The part that something of a state is in: its own, or that of the last state before it that has one.
  partOf(k, name) {
    while (k > 0 && !this.owned[k].has(name)) --k;
    return k > 0 ? `state${k}/${name}` : name;
  }
  fetch(k) { return fetchTile(this.data.states[k].fields, Boolean(this.data.lossy), name => this.partOf(k, name)); }
  // What draws a state; it begins to load when it is first asked for.
  drawing(k) {
    if (!this.drawings[k]) {
      const {canvas, layers, changed, missed} = this;
      this.drawings[k] = new Drawing(canvas, this.picture(k), layers, {fetch: this.fetch(k), changed, missed});
      this.loadHorizon(k).catch(() => missed('horizon'));
    }
    return this.drawings[k];
  }
  // The map of horizons comes when the picture is there.
  async loadHorizon(k) {
    const [width, height, azimuths] = this.data.states[k].horizon;
    if (width === 0) return;
    this.drawings[k].setHorizon(width, height, azimuths, await horizonOf(this.partOf(k, 'horizon'), Boolean(this.data.lossy)));
  }
  // Everything that these states were asked for is there, shadows included where they are wanted.
  complete(shown, shadows) {
    return shown.every(k => this.drawings[k]?.tiles.complete && (!shadows || this.drawings[k].horizon || !this.data.states[k].horizon[0]));
  }
}
