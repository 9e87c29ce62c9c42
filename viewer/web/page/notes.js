// notes.js: the annotations of a page: those that it was published with, and what was changed of them here, which the browser
// keeps.

import {annotationsIn, changedAnnotation, newAnnotation, pageOf, shapeOf, textOf, viewOf} from './annotation.js';

export class Notes {
  // data: id, width, height, annotations. changed(): after each change; told(text): words for all to see.
  constructor(data, changed, told) {
    Object.assign(this, {data, changed, told, key: `tangipaint ${data.id}`, edited: new Map(), removed: new Set()});
    this.published = data.annotations.filter(annotation => {
      try { return shapeOf(annotation, data); } catch (error) { console.warn(`annotation ${annotation.id}: ${error.message}`); }
    });
    try {
      const {edited = [], removed = []} = JSON.parse(localStorage.getItem(this.key) ?? '{}');
      for (const annotation of edited) {
        shapeOf(annotation, data);
        this.edited.set(annotation.id, annotation);
      }
      this.removed = new Set(removed);
    } catch (error) {
      console.warn(`what was kept of annotations cannot be read: ${error.message}`);
    }
    this.list();
  }
  // {annotation, shape, text, view} of each, in the order in which they came.
  list() {
    const published = new Set(this.published.map(a => a.id)), there = this.published.filter(a => !this.removed.has(a.id)).map(a => this.edited.get(a.id) ?? a);
    const all = [...there, ...[...this.edited.values()].filter(a => !published.has(a.id))];
    this.items = all.map(annotation => ({annotation, id: annotation.id, shape: shapeOf(annotation, this.data), text: textOf(annotation), view: viewOf(annotation)}));
  }
  find(id) { return this.items.find(item => item.id === id); }
  get isChanged() { return this.edited.size > 0 || this.removed.size > 0; }
  save() {
    this.list();
    try {
      if (this.isChanged) localStorage.setItem(this.key, JSON.stringify({edited: [...this.edited.values()], removed: [...this.removed]}));
      else localStorage.removeItem(this.key);
    } catch {
      this.told('This browser keeps nothing for this page: download the annotations before you leave it.');
    }
    this.changed();
  }
  add(shape, text, view) {
    const annotation = newAnnotation(shape, text, view, this.data);
    this.edited.set(annotation.id, annotation);
    this.save();
    return annotation.id;
  }
  change(id, by) {
    const item = this.find(id);
    if (!item) return;
    this.edited.set(id, changedAnnotation(item.annotation, by, this.data));
    this.save();
  }
  // What can be undone, once: before much is lost or added at a time.
  keep() { this.before = {edited: new Map(this.edited), removed: new Set(this.removed)}; }
  undo() {
    Object.assign(this, this.before);
    this.before = undefined;
    this.save();
  }
  remove(id) {
    this.keep();
    this.edited.delete(id);
    if (this.published.some(a => a.id === id)) this.removed.add(id);
    this.save();
  }
  // As it was published.
  restore() {
    this.keep();
    this.edited.clear();
    this.removed.clear();
    this.save();
  }
  // Adds those of a file's text; one of the same id replaces that which is there. Throws Error where something is wrong: then
  // none is added.
  load(text) {
    const read = annotationsIn(text, this.data);
    this.keep();
    for (const annotation of read) {
      this.edited.set(annotation.id, annotation);
      this.removed.delete(annotation.id);
    }
    this.save();
    const {width, height} = this.data, beyond = read.filter(a => this.find(a.id).shape.rings.flat().some(([x, y]) => x < -1 || y < -1 || x > width || y > height));
    return {count: read.length, beyond: beyond.length};
  }
  // Sets exactly these, as a page around this one does.
  replace(items) {
    const read = annotationsIn(JSON.stringify(items), this.data), ids = new Set(read.map(a => a.id));
    this.keep();
    this.edited = new Map(read.map(a => [a.id, a]));
    this.removed = new Set(this.published.map(a => a.id).filter(id => !ids.has(id)));
    this.save();
  }
  page() { return pageOf(this.items.map(item => item.annotation)); }
}
