// palette_sheet.js: paints from the tube, mixtures of them, the mixing board; gloss, roughness and medium of what is loaded.

import {button, choice, element, slider, toggle} from './controls.js';

export const css = rgb => rgb ? `rgb(${rgb.join(' ')})` : '#888';
const percent = v => `${Math.round(100 * v)} %`;

// paints: [{name, rgb}]; tool.paint: {name: part}; board: Board; changed() after each change.
export function fillPaletteSheet(sheet, {tool, paints, board, changed, startBoard, wipe, wash}) {
  const page = element('div');
  const pages = {paints: () => paintsPage(page, tool, paints, changed), board: () => boardPage(page, board, startBoard, wipe, wash), finish: () => finishPage(page, tool, changed)};
  const show = name => {
    tool.page = name;
    page.replaceChildren();
    pages[name]();
  };
  sheet.append(choice('Part of the palette', [['paints', 'Paints'], ['board', 'Mixing board'], ['finish', 'Gloss']], tool.page, show), page);
  show(tool.page);
}

function paintsPage(page, tool, paints, changed) {
  const grid = element('div', {className: 'paints', role: 'group', 'aria-label': 'Paints'}), bar = element('div', {className: 'mix', 'aria-hidden': 'true'});
  const list = element('ul', {className: 'parts', 'aria-label': 'Mixture'}), rgbOf = name => paints.find(p => p.name === name)?.rgb;
  const show = () => {
    for (const each of grid.children) each.setAttribute('aria-pressed', each.title in tool.paint);
    const sum = Object.values(tool.paint).reduce((a, b) => a + b, 0);
    bar.replaceChildren(...Object.entries(tool.paint).map(([name, part]) => {
      const piece = element('span');
      Object.assign(piece.style, {flex: part, background: css(rgbOf(name))});
      return piece;
    }));
    list.replaceChildren(...Object.entries(tool.paint).map(([name, part]) => row(name, part, sum)));
  };
  const set = paint => {
    tool.paint = paint;
    tool.goesOn = false;
    show();
    changed();
  };
  const row = (name, part, sum) => {
    const drop = element('span', {className: 'drop'}), less = {...tool.paint, [name]: part - 1};
    drop.style.background = css(rgbOf(name));
    if (part <= 1) delete less[name];
    return element('li', {}, drop, element('span', {textContent: name}), element('span', {textContent: percent(part / sum)}),
      element('button', {type: 'button', textContent: '−', 'aria-label': `Less ${name}`, disabled: Object.keys(less).length === 0, onclick: () => set(less)}),
      element('button', {type: 'button', textContent: '+', 'aria-label': `More ${name}`, onclick: () => set({...tool.paint, [name]: part + 1})}));
  };
  for (const {name, rgb} of paints) {
    const each = element('button', {type: 'button', title: name, 'aria-label': name, 'aria-pressed': 'false', onclick: () => {
      if (!tool.mixing) set({[name]: 1});
      else set({...tool.paint, [name]: (tool.paint[name] ?? 0) + 1});
    }});
    each.style.background = css(rgb);
    grid.append(each);
  }
  page.append(element('div', {style: 'height:12px'}), grid, toggle('Add to the mixture', tool.mixing, on => { tool.mixing = on; }), bar, list);
  show();
}

function boardPage(page, board, startBoard, wipe, wash) {
  page.append(element('div', {className: 'row', style: 'margin-top:10px'}, button('Lay out', startBoard, {'aria-label': 'Lay out paints'}), button('Wipe', wipe, {'aria-label': 'Wipe the board'}), button('Wash brush', wash)),
    board.canvas, element('p', {className: 'hint', textContent: 'Paint here to mix: the brush takes up what it meets, and goes on with it on the painting.'}));
}

function finishPage(page, tool, changed) {
  const {finish} = tool, put = key => v => { finish[key] = v; changed(); };
  const own = element('div'), show = () => {
    own.replaceChildren(...finish.own ? [
      slider({label: 'Gloss ρs', from: 0, to: 0.2, value: finish.specular, words: v => v.toFixed(3), changed: put('specular')}),
      slider({label: 'Roughness α', from: 0.02, to: 0.8, value: finish.roughness, words: v => v.toFixed(2), changed: put('roughness'), logarithmic: true}),
    ] : []);
  };
  page.append(slider({label: 'Medium', from: 0, to: 0.95, value: finish.medium, words: v => v < 0.005 ? 'none' : percent(v), changed: put('medium')}),
    element('p', {className: 'hint', textContent: 'Clear medium makes a glaze: what lies below shows through.'}),
    toggle('Other gloss than the paint’s own', finish.own, on => { finish.own = on; show(); changed(); }), own);
  show();
}

// The mixing board: a picture that the engine draws, and strokes on it.
export class Board {
  // on: {begin(event, place) -> stroke, add, end}: as Input has them.
  constructor(on) {
    this.canvas = element('canvas', {id: 'board', width: 400, height: 300, tabIndex: 0, 'aria-label': 'Mixing board: drag to mix paints', role: 'img'});
    this.mm = {width: 200, height: 150};
    const {canvas} = this;
    canvas.addEventListener('pointerdown', event => {
      event.preventDefault();
      canvas.setPointerCapture(event.pointerId);
      this.stroke = on.begin(event, e => this.place(e));
    });
    canvas.addEventListener('pointermove', event => { if (this.stroke && event.buttons) on.add(this.stroke, event); });
    for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, event => {
      if (this.stroke) on.end(this.stroke, event);
      this.stroke = null;
    });
  }
  // [mm] from the middle, x right, y up.
  place(event) {
    const box = this.canvas.getBoundingClientRect();
    return [((event.clientX - box.left) / box.width - 0.5) * this.mm.width, (0.5 - (event.clientY - box.top) / box.height) * this.mm.height];
  }
  take({width, height, x, y, columns, rows, bytes}, mmPerPixel) {
    const {canvas} = this;
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, {width, height});
    this.mm = {width: width * mmPerPixel, height: height * mmPerPixel};
    canvas.getContext('2d').putImageData(new ImageData(new Uint8ClampedArray(bytes.buffer), columns, rows), x, y);
  }
  clear() { this.canvas.getContext('2d').clearRect(0, 0, this.canvas.width, this.canvas.height); }
}
