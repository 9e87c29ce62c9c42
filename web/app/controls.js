// controls.js: the few kinds of controls that sheets are made of, and sheets.

export const at = id => document.getElementById(id);

// An element with properties, attributes (data-, aria-) and children.
export function element(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name.includes('-')) made.setAttribute(name, value);
    else made[name] = value;
  }
  made.append(...children.filter(child => child !== null && child !== undefined));
  return made;
}
export function icon(name) {
  const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg'), use = document.createElementNS('http://www.w3.org/2000/svg', 'use');
  use.setAttribute('href', `#i-${name}`);
  svg.setAttribute('aria-hidden', 'true');
  svg.append(use);
  return svg;
}
export const button = (text, onclick, properties = {}) => element('button', {type: 'button', className: 'button', textContent: text, onclick, ...properties});

// A slider with its value in words. `from`, `to` on a scale that may be `logarithmic`. settled(): it was let go.
export function slider({label, from, to, value, words, changed, settled = () => {}, logarithmic = false}) {
  const position = v => logarithmic ? Math.log(v / from) / Math.log(to / from) : (v - from) / (to - from);
  const reading = p => logarithmic ? from * (to / from) ** p : from + (to - from) * p;
  const input = element('input', {type: 'range', min: 0, max: 1, step: 0.001, value: position(value), 'aria-label': label});
  const output = element('output', {textContent: words(value)});
  const told = v => {
    output.textContent = words(v);
    input.setAttribute('aria-valuetext', words(v));
  };
  told(value);
  input.oninput = () => {
    const v = reading(Number(input.value));
    told(v);
    changed(v);
  };
  input.onchange = () => settled();
  const made = element('div', {className: 'slider'}, element('span', {textContent: label}), output, input);
  made.show = v => {
    input.value = position(v);
    told(v);
  };
  return made;
}
// One of several: options [[value, label], …].
export function choice(label, options, value, changed) {
  const made = element('div', {className: 'choice', role: 'group', 'aria-label': label});
  const show = now => { for (const each of made.children) each.setAttribute('aria-pressed', each.dataset.value === String(now)); };
  for (const [of, text] of options)
    made.append(element('button', {type: 'button', textContent: text, 'data-value': of, 'aria-pressed': 'false', onclick: () => { show(of); changed(of); }}));
  show(value);
  made.show = show;
  return made;
}
export function toggle(label, value, changed) {
  const input = element('input', {type: 'checkbox', checked: value, role: 'switch', 'aria-label': label, onchange: () => changed(input.checked)});
  const made = element('label', {className: 'switch'}, element('span', {textContent: label}), input);
  made.show = v => { input.checked = v; };
  return made;
}

// Sheets: one is open at a time; its button says so. `fill(sheet)` makes what is in it when it opens.
export class Sheets {
  // changed(): another one is open, or none.
  constructor(changed) {
    Object.assign(this, {changed, fills: new Map(), open: null});
    document.addEventListener('keydown', event => { if (event.key === 'Escape' && this.open) this.close(true); });
  }
  add(name, title, fill) {
    this.fills.set(name, {title, fill});
    at(`open-${name}`).onclick = () => this.open === name ? this.close() : this.show(name);
  }
  show(name) {
    if (this.open) this.close();
    const sheet = at(`sheet-${name}`), {title, fill} = this.fills.get(name);
    const close = element('button', {type: 'button', className: 'close', 'aria-label': `Close ${title}`, onclick: () => this.close(true)}, icon('close'));
    sheet.replaceChildren(element('header', {}, element('h2', {textContent: title}), close));
    fill(sheet);
    sheet.hidden = false;
    sheet.scrollTop = 0;
    at(`open-${name}`).setAttribute('aria-expanded', 'true');
    this.open = name;
    this.changed();
  }
  // What is open, made anew.
  refresh(name) {
    if (this.open !== name) return;
    const sheet = at(`sheet-${name}`), scrolled = sheet.scrollTop;
    this.show(name);
    sheet.scrollTop = scrolled;
  }
  close(focus = false) {
    const name = this.open;
    if (!name) return;
    at(`sheet-${name}`).hidden = true;
    at(`open-${name}`).setAttribute('aria-expanded', 'false');
    this.open = null;
    if (focus) at(`open-${name}`).focus();
    this.changed();
  }
}

let hiding = 0;
// Words at the top, for a while; a warning stays until the next.
export function notice(text, warns = false) {
  const place = at('notice');
  clearTimeout(hiding);
  place.textContent = text;
  place.classList.toggle('warns', warns);
  place.classList.toggle('shown', Boolean(text));
  if (!warns) hiding = setTimeout(() => place.classList.remove('shown'), 3500);
}

// Asks in a dialog; promises the value of the button, or null.
export function ask(title, words, ends) {
  const dialog = at('asked');
  return new Promise(resolve => {
    const finish = value => {
      dialog.close();
      resolve(value);
    };
    dialog.replaceChildren(element('h2', {id: 'asked-title', textContent: title}), element('p', {textContent: words}),
      element('div', {className: 'ends'}, ...ends.map(([value, text, kind]) => button(text, () => finish(value), {className: `button ${kind ?? ''}`}))));
    dialog.oncancel = () => resolve(null);
    dialog.showModal();
  });
}
export function busy(words, part = null) {
  at('busy').hidden = words === null;
  if (words === null) return;
  at('busy-words').textContent = words;
  if (part === null) at('busy-part').removeAttribute('value');
  else busyPart(part);
}
// How far that is, 0 to 1.
export function busyPart(part) { at('busy-part').value = part; }
