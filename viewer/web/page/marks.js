// marks.js: what is drawn over the picture, as SVG: annotations, what is being drawn, the ruler; and the buttons that choose an
// annotation.

function svgElement(svg, name, attributes, text) {
  const element = document.createElementNS(svg.namespaceURI, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  return element;
}

export class Marks {
  // svg: over the whole picture; buttons: <div> of the same size; choose(id).
  constructor(svg, buttons, choose) { Object.assign(this, {svg, buttons, choose}); }

  // items: of Notes, [] where they are hidden. toCss: place on the painting -> [CSS pixels]. words: what the ruler says.
  draw({items, selected, draft, cross, ruler}, toCss, words) {
    const {svg} = this, add = (parent, ...what) => parent.appendChild(svgElement(svg, ...what));
    svg.querySelectorAll(':scope > g').forEach(g => g.remove());
    const path = (ring, closed) => ring.map((p, i) => `${i ? 'L' : 'M'}${toCss(p).map(v => v.toFixed(1)).join(' ')}`).join('') + (closed ? 'Z' : '');
    const outline = (group, rings, closed) => {
      const d = rings.map(ring => path(ring, closed)).join('');
      add(group, 'path', {class: 'under', d});
      add(group, 'path', {class: closed ? 'area' : 'stroke', d, 'fill-rule': 'evenodd'});
    };
    items.forEach(({id, shape, text}, i) => {
      const group = add(svg, 'g', {class: id === selected ? 'note chosen' : 'note'}), [x, y] = toCss(shape.rings[0][0]);
      if (shape.kind === 'line' || shape.kind === 'polygon') outline(group, shape.rings, shape.kind === 'polygon');
      if (shape.kind === 'text') add(group, 'text', {class: 'label', x: x + 18, y: y + 6}, text.split('\n')[0]);
      add(group, 'circle', {cx: x, cy: y, r: 12});
      add(group, 'text', {class: 'number', x, y: y + 4.5}, i + 1);
    });
    if (draft) {
      const group = add(svg, 'g', {class: 'note draft'});
      if (draft.points.length > 1) outline(group, [draft.points], false);
      for (const p of draft.points) add(group, 'circle', {cx: toCss(p)[0], cy: toCss(p)[1], r: 5});
    }
    if (ruler) this.drawRuler(add, ruler.map(toCss), words);
    if (cross) this.drawCross(add, toCss(cross));
    this.place(items, selected, toCss);
  }
  drawRuler(add, [a, b], words) {
    const group = add(this.svg, 'g', {class: 'ruler'}), ends = {x1: a[0], y1: a[1], x2: b[0], y2: b[1]};
    add(group, 'line', {class: 'under', ...ends});
    add(group, 'line', ends);
    add(group, 'text', {id: 'distance', x: (a[0] + b[0]) / 2 + 10, y: (a[1] + b[1]) / 2 - 10}, words);
  }
  drawCross(add, [x, y]) {
    const group = add(this.svg, 'g', {class: 'cross'}), d = `M${x - 16} ${y}h12m8 0h12M${x} ${y - 16}v12m0 8v12`;
    add(group, 'path', {class: 'under', d});
    add(group, 'path', {d});
  }
  // A button of 44 pixels on the number of each.
  place(items, selected, toCss) {
    while (this.buttons.children.length > items.length) this.buttons.lastChild.remove();
    items.forEach(({id, shape, text}, i) => {
      const button = this.buttons.children[i] ?? this.buttons.appendChild(document.createElement('button')), [x, y] = toCss(shape.rings[0][0]);
      const label = `Annotation ${i + 1}: ${text.split('\n')[0] || 'without text'}`;
      button.onclick = () => this.choose(id);
      if (button.getAttribute('aria-label') !== label) button.setAttribute('aria-label', label);
      button.setAttribute('aria-pressed', id === selected);
      button.style.transform = `translate(${(x - 22).toFixed(1)}px, ${(y - 22).toFixed(1)}px)`;
    });
  }
}
