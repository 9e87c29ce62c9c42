// notes_pane.js: the list of annotations, and what is done to them.

import {saveAs} from './measure.js';

const kindNames = {point: 'Point', line: 'Line', polygon: 'Polygon', text: 'Text'};

export class NotesPane {
  // pane: <aside id="notes">; choose(id or null), view(): the words of what is shown now, told(text): words for all to see.
  constructor(pane, notes, {choose, view, told, title}) {
    Object.assign(this, {pane, notes, choose, view, told});
    const on = (selector, act) => { this.within(selector).onclick = act; };
    on('.close', () => this.open(false));
    on('.save', () => saveAs(new Blob([JSON.stringify(notes.page(), null, 2)], {type: 'application/ld+json'}), `${title}.annotations.json`));
    on('.load', () => this.within('input').click());
    on('.undo', () => notes.undo());
    on('.restore', () => notes.restore());
    this.within('input').onchange = event => this.load(event.target);
  }
  within(selector) { return this.pane.querySelector(selector); }
  get isOpen() { return !this.pane.hidden; }
  open(shown) {
    this.pane.hidden = !shown;
    this.shownAs = '';
    this.choose(null);
  }
  async load(input) {
    const [file] = input.files;
    if (!file) return;
    try {
      const {count, beyond} = this.notes.load(await file.text());
      this.told(`${count === 1 ? 'One annotation was' : `${count} annotations were`} loaded.${beyond ? ` ${beyond} of them reach beyond this painting: they may be of another one.` : ''}`);
    } catch (error) {
      this.told(`${file.name}: ${error.message}. Nothing was loaded.`);
    }
    input.value = '';
  }
  // The list as it is now; what is being typed stays.
  draw(selected) {
    const {notes} = this, shownAs = JSON.stringify([selected, notes.items.map(item => [item.id, item.text])]);
    this.within('.undo').disabled = !notes.before;
    this.within('.restore').hidden = !notes.published.length;
    this.within('.restore').disabled = !notes.isChanged;
    this.within('.save').disabled = !notes.items.length;
    if (shownAs === this.shownAs || this.pane.hidden) return;
    this.shownAs = shownAs;
    const list = this.within('ol'), typed = document.activeElement?.closest('#notes textarea') && this.selected === selected;
    if (typed) {
      this.name(list.querySelector('.chosen .choose'), notes.find(selected), notes.items.findIndex(item => item.id === selected));
      return;
    }
    this.selected = selected;
    list.replaceChildren(...notes.items.map((item, i) => this.row(item, i, item.id === selected)));
    this.within('.none').hidden = notes.items.length > 0;
  }
  name(button, {text, shape}, i) { button.textContent = `${i + 1} · ${text.split('\n')[0] || kindNames[shape.kind]}`; }
  row(item, i, chosen) {
    const row = document.createElement('li'), button = row.appendChild(document.createElement('button'));
    row.className = chosen ? 'chosen' : '';
    button.className = 'choose';
    this.name(button, item, i);
    button.setAttribute('aria-expanded', chosen);
    button.onclick = () => {
      this.choose(chosen ? null : item.id);
      this.pane.querySelectorAll('.choose')[i]?.focus();
    };
    if (chosen) row.append(...this.editor(item, i));
    return row;
  }
  editor({id, text}, i) {
    const area = document.createElement('textarea'), keep = document.createElement('button'), gone = document.createElement('button');
    Object.assign(area, {value: text, rows: 3, placeholder: 'What is to be seen here?'});
    area.setAttribute('aria-label', `Text of annotation ${i + 1}`);
    area.oninput = () => this.notes.change(id, {text: area.value});
    Object.assign(keep, {textContent: 'Keep this view', title: 'it shows the light, view and look of now whenever it is chosen', onclick: () => {
      this.notes.change(id, {view: this.view()});
      this.told('The annotation keeps light, view and look as they are now.');
    }});
    Object.assign(gone, {textContent: 'Delete', onclick: () => {
      this.notes.remove(id);
      this.choose(null);
      (this.pane.querySelectorAll('.choose')[Math.min(i, this.notes.items.length - 1)] ?? this.within('h2')).focus();
    }});
    return [area, keep, gone];
  }
  // To be written into at once: one that has just been drawn.
  edit(id) {
    this.pane.hidden = false;
    this.draw(id);
    this.within('.chosen textarea')?.focus();
    this.within('.chosen')?.scrollIntoView({block: 'nearest'});
  }
}
