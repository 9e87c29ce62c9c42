// annotation.js: annotations as W3C Web Annotations (REC-annotation-model-20170223), and their shapes.
//
// A shape is {kind: 'point' | 'line' | 'polygon' | 'text', rings: lists of [x, y]}: pixels of the painting, whole numbers are
// centres. In selectors pixels begin at whole numbers: half a pixel more. An annotation's view is its target's state: what is
// behind the # of a link to it, in `value`.

const annotationContext = 'http://www.w3.org/ns/anno.jsonld', svgSpace = 'http://www.w3.org/2000/svg', viewType = 'urn:tangipaint:View';
const samplesOfCurve = 64;

// Random, RFC 9562; crypto.randomUUID() is for secure pages alone.
export function newId() {
  const bytes = crypto.getRandomValues(new Uint8Array(16));
  bytes[6] = bytes[6] & 0x0f | 0x40;
  bytes[8] = bytes[8] & 0x3f | 0x80;
  return `urn:uuid:${Array.from(bytes, (b, i) => ([4, 6, 8, 10].includes(i) ? '-' : '') + b.toString(16).padStart(2, '0')).join('')}`;
}

const number = v => String(+(v + 0.5).toFixed(2));
const escapedText = text => text.replace(/[&<>]/g, c => ({'&': '&amp;', '<': '&lt;', '>': '&gt;'})[c]);

// `side` [pixels]: the painting's longer one, by which a point and a word are large enough to be seen.
export function svgOf({kind, rings}, text, side) {
  const pairs = ring => ring.map(p => p.map(number).join(',')).join(' '), [x, y] = rings[0][0].map(number), size = v => +(v * side).toFixed(1);
  const path = () => `<path fill-rule="evenodd" d="${rings.map(ring => `M${pairs(ring)}Z`).join('')}"/>`;
  const inner = {
    point: () => `<circle class="point" cx="${x}" cy="${y}" r="${size(0.005)}"/>`,
    line: () => `<polyline fill="none" points="${pairs(rings[0])}"/>`,
    polygon: () => rings.length === 1 ? `<polygon points="${pairs(rings[0])}"/>` : path(),
    text: () => `<text x="${x}" y="${y}" font-size="${size(0.025)}">${escapedText(text.split('\n')[0])}</text>`,
  }[kind]();
  return `<svg xmlns="${svgSpace}">${inner}</svg>`;
}

const numbersIn = text => (text.match(/[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?/gi) ?? []).map(Number);
const pairsOf = numbers => Array.from({length: numbers.length >> 1}, (_, i) => [numbers[2 * i], numbers[2 * i + 1]]);

// Outlines of a path. Straight ones are read here, exactly; curves are sampled by the browser, which knows them all.
function ringsOfPath(d) {
  const rings = [];
  let at = [0, 0], start = at, ring = [];
  const to = point => { ring.push(at = point); };
  for (const [, command, rest] of d.matchAll(/([a-df-z])([^a-df-z]*)/gi)) {
    const letter = command.toUpperCase(), relative = command !== letter, numbers = numbersIn(rest), [ox, oy] = [() => relative ? at[0] : 0, () => relative ? at[1] : 0];
    if (letter === 'M') {
      if (ring.length) rings.push(ring);
      ring = [];
    }
    if ('ML'.includes(letter)) for (const [i, [x, y]] of pairsOf(numbers).entries()) {
      to([ox() + x, oy() + y]);
      if (letter === 'M' && i === 0) start = at;
    } else if (letter === 'H') for (const x of numbers) to([ox() + x, at[1]]);
    else if (letter === 'V') for (const y of numbers) to([at[0], oy() + y]);
    else if (letter === 'Z') at = start;
    else return [sampledPath(d)];
  }
  return [...rings, ring];
}
function sampledPath(d) {
  const path = document.createElementNS(svgSpace, 'path');
  path.setAttribute('d', d);
  const length = path.getTotalLength();
  return Array.from({length: samplesOfCurve}, (_, i) => path.getPointAtLength(length * i / (samplesOfCurve - 1))).map(p => [p.x, p.y]);
}

function ringsOfElement(element) {
  const of = name => Number.parseFloat(element.getAttribute(name) ?? '0');
  const round = (rx, ry) => [Array.from({length: samplesOfCurve}, (_, i) => 2 * Math.PI * i / samplesOfCurve).map(a => [of('cx') + rx * Math.cos(a), of('cy') + ry * Math.sin(a)])];
  const [x, y, w, h] = ['x', 'y', 'width', 'height'].map(of), points = () => [pairsOf(numbersIn(element.getAttribute('points') ?? ''))];
  return {
    circle: () => element.getAttribute('class') === 'point' ? [[[of('cx'), of('cy')]]] : round(of('r'), of('r')), ellipse: () => round(of('rx'), of('ry')),
    rect: () => [[[x, y], [x + w, y], [x + w, y + h], [x, y + h]]], line: () => [[[of('x1'), of('y1')], [of('x2'), of('y2')]]],
    polyline: points, polygon: points, path: () => ringsOfPath(element.getAttribute('d') ?? ''), text: () => [[[x, y]]],
  }[element.localName]();
}
function kindOf(element, rings) {
  if (element.localName === 'text') return 'text';
  if (rings.length === 1 && rings[0].length === 1) return 'point';
  const open = ['line', 'polyline'].includes(element.localName) || element.localName === 'path' && !/z/i.test(element.getAttribute('d'));
  return open || rings[0].length < 3 ? 'line' : 'polygon';
}

const fewestPoints = {polygon: 3, polyline: 2};
function requirePoints(element) {
  const name = element.localName, points = element.getAttribute('points') ?? '', count = numbersIn(points).length / 2, fewest = fewestPoints[name] ?? 0;
  if (fewest && /[^-+.\de\s,]/i.test(points)) throw new Error(`its SvgSelector has a ${name} with points that are no numbers: ${points.slice(0, 40)}`);
  if (count < fewest || fewest && count % 1) throw new Error(`its SvgSelector has a ${name} with ${count} points, and takes ${fewest} or more`);
}

// Nothing of it gets into the page but its numbers.
function shapeOfSvg(text) {
  const root = new DOMParser().parseFromString(text, 'image/svg+xml').documentElement;
  if (root.localName !== 'svg' || root.querySelector('parsererror')) throw new Error('its SvgSelector is not well-formed SVG');
  const elements = [...root.querySelectorAll('circle, ellipse, rect, line, polyline, polygon, path, text')];
  if (!elements.length) throw new Error('its SvgSelector has no shape: circle, ellipse, rect, line, polyline, polygon, path or text');
  elements.forEach(requirePoints);
  const found = elements.map(ringsOfElement), rings = found.flat().map(ring => ring.map(p => p.map(v => v - 0.5)));
  if (!rings.length || rings.some(ring => !ring.length || ring.flat().some(v => !Number.isFinite(v)))) throw new Error('its SvgSelector has a shape without numbers');
  const closed = elements.length > 1 && found.every((r, i) => kindOf(elements[i], r) === 'polygon');
  return {kind: closed ? 'polygon' : kindOf(elements[0], elements.length > 1 ? found[0] : rings), rings: closed ? rings : rings.slice(0, found[0].length)};
}
function shapeOfFragment(value, {width, height}) {
  const [, unit, list] = /^xywh=(?:(pixel|percent):)?([-\d.,]+)$/.exec(value) ?? [], [x, y, w, h] = (list ?? '').split(',').map(Number);
  if (![x, y, w, h].every(Number.isFinite)) throw new Error(`its FragmentSelector "${value}" is no xywh=x,y,width,height`);
  const [sx, sy] = unit === 'percent' ? [width / 100, height / 100] : [1, 1], corner = (a, b) => [a * sx - 0.5, b * sy - 0.5];
  return {kind: 'polygon', rings: [[corner(x, y), corner(x + w, y), corner(x + w, y + h), corner(x, y + h)]]};
}

// The shape of an annotation on a picture {width, height}. Throws Error that says what is wrong.
export function shapeOf({target}, picture) {
  const targets = [target].flat(), fragment = typeof targets[0] === 'string' ? /#(xywh=.*)$/.exec(targets[0]) : null;
  if (fragment) return shapeOfFragment(fragment[1], picture);
  const selectors = [targets[0]?.selector ?? []].flat();
  for (const {type, value, x, y} of selectors) {
    if (type === 'SvgSelector') return shapeOfSvg(String(value));
    if (type === 'FragmentSelector') return shapeOfFragment(String(value), picture);
    if (type === 'PointSelector' && Number.isFinite(x) && Number.isFinite(y)) return {kind: 'point', rings: [[[x - 0.5, y - 0.5]]]};
  }
  throw new Error(selectors.length ? `its selector, ${selectors[0].type}, is none of SvgSelector, FragmentSelector and PointSelector` : 'it has no selector, so it lies nowhere');
}

const bodiesOf = ({body, bodyValue}) => typeof bodyValue === 'string' ? [{type: 'TextualBody', value: bodyValue}] : [body ?? []].flat();
// What people read of it.
export const textOf = annotation => bodiesOf(annotation).map(b => typeof b === 'string' ? b : b.value).filter(v => typeof v === 'string').join('\n');
// The view that it keeps, as words; '' where it has none.
export const viewOf = ({target}) => [[target].flat()[0]?.state ?? []].flat().find(s => s.type === viewType)?.value ?? '';

export function newAnnotation(shape, text, view, data) {
  const now = new Date().toISOString();
  const annotation = {'@context': annotationContext, id: newId(), type: 'Annotation', motivation: 'commenting', created: now};
  return changedAnnotation({...annotation, body: [], target: {type: 'SpecificResource', source: data.id}}, {shape, text, view}, data);
}
// The same with another shape, text or view; whatever else it holds stays as it is.
export function changedAnnotation(annotation, {shape, text, view}, data) {
  const changed = {...annotation, modified: new Date().toISOString()};
  const target = typeof annotation.target === 'string' || Array.isArray(annotation.target) ? {type: 'SpecificResource', source: annotation.target} : {...annotation.target};
  if (text !== undefined) {
    const others = bodiesOf(annotation).filter(b => typeof b === 'object' && b.type !== 'TextualBody');
    changed.body = [{type: 'TextualBody', purpose: 'describing', format: 'text/plain', value: text}, ...others];
    delete changed.bodyValue;
  }
  const drawn = shape ?? shapeOf(annotation, data);
  if (shape || text !== undefined && drawn.kind === 'text')
    target.selector = {type: 'SvgSelector', value: svgOf(drawn, text ?? textOf(annotation), Math.max(data.width, data.height))};
  if (view !== undefined) target.state = {type: viewType, value: view};
  return {...changed, target};
}

export const pageOf = items => ({'@context': annotationContext, id: newId(), type: 'AnnotationPage', items});

// The annotations of a file: an AnnotationPage, an AnnotationCollection with its first page, a list, one annotation, or a
// manifest of IIIF with them. Throws Error that names the place and says what is wrong.
export function annotationsIn(text, picture) {
  let read;
  try { read = JSON.parse(text); } catch (error) { throw new Error(`is no JSON: ${error.message}`); }
  const canvas = read?.type === 'Manifest' ? read.items?.[0]?.annotations?.flatMap(page => page.items ?? []) : null;
  const items = canvas ?? (Array.isArray(read) ? read : read?.type === 'Annotation' ? [read] : read?.items ?? read?.first?.items);
  if (!Array.isArray(items)) throw new Error("is no AnnotationPage of W3C Web Annotations: it has no list 'items'");
  const numbers = new Map();
  return items.map((item, i) => {
    if (typeof item?.id === 'string' && numbers.has(item.id)) throw new Error(`item ${i + 1} has the id of item ${numbers.get(item.id)}: ${item.id}`);
    numbers.set(item?.id, i + 1);
    if (item?.type !== 'Annotation' || !item.target) throw new Error(`item ${i + 1} is no Annotation with a target`);
    try { shapeOf(item, picture); } catch (error) { throw new Error(`item ${i + 1}: ${error.message}`); }
    return {...item, id: typeof item.id === 'string' ? item.id : newId()};
  });
}
