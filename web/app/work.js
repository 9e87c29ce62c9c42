// work.js: the painting that is open: its journal as it grows, in the engine and on the disk.

import {isFull} from './storage.js';

export const firstLine = on => JSON.stringify({format: 'tangipaint strokes', version: 1, ...(on ? {on} : {})});

export class Work {
  // on: {kept(), full(lines), lost(message)}.
  constructor(storage, connection, record, next, on) {
    Object.assign(this, {storage, connection, record, next, on, pending: new Map(), writing: null, seeds: next});
    this.refused = new Set();
  }
  // Lines of a stroke that is under way, or of one event; `ends` after the last of them.
  send(lines, ends) {
    this.lines = [...this.lines ?? [], ...lines];
    this.connection.paint(lines, this.next);
    if (!ends) return;
    this.pending.set(this.next++, this.lines.map(line => `${line}\n`).join(''));
    this.lines = null;
    this.write();
  }
  event(event) { this.send([JSON.stringify(event)], true); }
  get strokes() { return this.next; }
  // From which the bristles of the next stroke are drawn.
  seed() { return this.seeds++; }

  // Writes what waits, in order. What does not fit stays, and is tried again with the next stroke.
  async write() {
    if (this.writing) return this.writing;
    this.writing = (async () => {
      await null;  // so that it ends after it is known, also where there is nothing to wait for
      try {
        for (const [number, text] of this.pending) {
          if (!this.refused.has(number)) await this.store(number, text);
          this.pending.delete(number);
        }
        this.on.kept();
      } catch (error) {
        if (isFull(error)) this.on.full(this.pending.size);
        else this.on.lost(error.message);
      } finally {
        this.writing = null;
      }
    })();
    return this.writing;
  }
  // Where the disk is full, what can be made again makes room.
  async store(number, text) {
    const append = () => this.storage.append(this.record.id, number, text);
    try {
      await append();
    } catch (error) {
      if (!isFull(error)) throw error;
      await this.connection.ask('forget');
      await append();
    }
  }
  // The engine could not do it: it is not of the journal.
  async refuse(number) {
    this.refused.add(number);
    if (number < this.next && !this.pending.has(number)) await this.storage.drop(this.record.id, number);
  }
  get unstored() { return this.pending.size; }

  // The painting file that it is painted on, a Blob; null where that is another support.
  original() { return this.storage.original(this.record); }
  // The whole journal as a file has it.
  async text() {
    await this.writing;
    const {text} = await this.storage.journal(this.record.id);
    return `${firstLine(this.record.head)}\n${text}${[...this.pending.values()].join('')}`;
  }
}
