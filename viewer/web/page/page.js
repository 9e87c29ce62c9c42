// page.js: the page: controls, what is drawn when, links to a view.

const at = id => document.getElementById(id), canvas = at('picture');
const toolNames = [['light', 'Light', 'drag: move the light over the painting (L)'], ['tilt', 'Tilt', 'drag: tilt the painting (T)'],
  ['pan', 'Move', 'drag: move the painting (H); two fingers or the wheel zoom'], ['ruler', 'Measure', 'drag: measure a distance (M)']];
const state = {
  view: {x: (data.width - 1) / 2, y: (data.height - 1) / 2, zoom: 1, turn: 0}, tilt: {x: 0, y: 0, vx: 0, vy: 0, returning: false},
  light: {azimuth: data.light_deg[0], elevation: data.light_deg[1]}, tool: 'light', look: 0, shadows: true, sweeping: false,
  loupe: false, ruler: null, exposure: 0, ambient: 0.03, shoulder: 0.15, ui: true,
};
const screen = {width: 1, height: 1};
let drawing, scale = 1, wanted = false, frameTime = 0, placed = false, fittedZoom = 0;

// A link holds what it shows: #azimuth=135&elevation=20&look=1&x=…&y=…&zoom=…; the whole painting where zoom is left out.
// Of each number: where it is in the state, and what of any number can be shown, as the hand would reach it.
const within = (low, high) => value => clamp(value, low, high), around = value => value - 360 * Math.ceil((value - 180) / 360);
const linked = {
  azimuth: ['light', 'azimuth', around], elevation: ['light', 'elevation', within(lowestLight, 90)],
  tilt_x: ['tilt', 'x', within(-mostTilt, mostTilt)], tilt_y: ['tilt', 'y', within(-mostTilt, mostTilt)],
  x: ['view', 'x', within(0, data.width - 1)], y: ['view', 'y', within(0, data.height - 1)], zoom: ['view', 'zoom', within(leastZoom, mostZoom)],
  turn: ['view', 'turn', around], look: ['look', '', value => clamp(Math.round(value), 0, data.looks.length - 1)],
  exposure: ['exposure', '', within(-3, 3)], ambient: ['ambient', '', within(0, 1)], shoulder: ['shoulder', '', within(0, 1)],
};
// True where it says what part of the painting to show.
function readLink() {
  const words = new URLSearchParams(location.hash.slice(1));
  for (const [name, [key, inner, shown]] of Object.entries(linked)) {
    const word = (words.get(name) ?? '').trim().replace(',', '.'), value = Number(word);
    if (!word || !Number.isFinite(value)) continue;
    if (inner) state[key] = {...state[key], [inner]: shown(value)};
    else state[key] = shown(value);
    if (key === 'light') state.sweeping = false;
    if (key === 'tilt') Object.assign(state.tilt, {vx: 0, vy: 0, returning: false});
  }
  for (const key of ['shadows', 'ui']) if (words.has(key)) state[key] = words.get(key) !== '0';
  if (toolNames.some(([name]) => name === words.get('tool'))) state.tool = words.get('tool');
  document.body.classList.toggle('bare', !state.ui);
  return words.has('zoom');
}
function link() {
  const words = Object.entries(linked).map(([name, [key, inner]]) => [name, +(inner ? state[key][inner] : state[key]).toFixed(4)]);
  const hash = new URLSearchParams([...words, ['shadows', +state.shadows], ['tool', state.tool]]).toString();
  return `${location.href.split('#')[0]}#${hash}`;
}

function scene(placement) {
  const look = data.looks[state.look].name;
  return {light: placement.inSurface(directionOf(state.light)), look: state.look, shadows: state.shadows, ambient: state.ambient,
    exposure: state.exposure, shoulder: state.shoulder, strength: look === 'Specular enhancement' ? 0.7 : 2.1,
    sharpness: look === 'Unsharp normals' ? 3 : 40};
}

function draw(moving) {
  const placement = hand.placement(), part = moving ? scale : 1, looks = scene(placement), seen = placement.seen();
  const width = Math.max(1, Math.round(screen.width * part)), height = Math.max(1, Math.round(screen.height * part));
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, {width, height});
  const {tiles} = drawing, level = tiles.affordable(placement.level(part), seen), views = [{level, seen}];
  if (data.looks[state.look].name === 'Unsharp normals') views.push({level: Math.min(level + 3, data.levels - 1), seen});
  const loupe = loupeShot(placement, part);
  if (loupe) views.push({level: loupe.shot.level, seen: loupe.seen});
  tiles.want(views);
  drawing.draw(looks, {matrix: placement.shot(width, height), eye: placement.eye, level, smooth: !moving}, {left: 0, bottom: 0, width, height});
  if (loupe) drawing.draw(looks, loupe.shot, loupe.rectangle);
  lens(loupe, part);
  document.documentElement.dataset.drawn = !moving && tiles.complete && (!state.shadows || drawing.horizon || !data.horizon[0]) ? 'whole' : 'part';
}

// What is under the cursor four times as large, in a square of the canvas.
function loupeShot(placement, part) {
  const cursor = hand.cursor, under = state.loupe && cursor && placement.toPainting(...cursor);
  if (!under) return null;
  const side = Math.round(Math.min(240 * devicePixelRatio, screen.width / 2, screen.height / 2)), larger = 4;
  const place = new Placement({...state.view, x: under[0], y: under[1], zoom: state.view.zoom * larger}, state.tilt, {width: side, height: side});
  const size = Math.max(1, Math.round(side * part)), middle = v => Math.round(v * part - size / 2);
  const rectangle = {left: middle(cursor[0]), bottom: middle(screen.height - cursor[1]), width: size, height: size};
  const shot = {matrix: place.shot(size, size, rectangle.left, rectangle.bottom), eye: place.eye, level: place.level(part), smooth: true};
  return {shot, rectangle, seen: place.seen()};
}
function lens(loupe, part) {
  at('lens').style.display = loupe ? '' : 'none';
  if (!loupe) return;
  const css = canvas.clientWidth / screen.width / part, {left, bottom, width, height} = loupe.rectangle;
  Object.assign(at('lens').style, {left: `${left * css}px`, bottom: `${bottom * css}px`, width: `${width * css}px`, height: `${height * css}px`});
}

// One frame, when something has changed; coarser while it moves on a slow machine.
function frame(now) {
  const seconds = Math.min((now - frameTime) / 1000, 0.1), follows = now - frameTime < 100;
  if (drawing.moved && follows) scale = clamp(seconds > 0.025 ? scale * 0.85 : seconds < 0.018 ? scale * 1.05 : scale, 0.25, 1);
  frameTime = now;
  const goesOn = hand.advance(seconds), moving = goesOn || (wanted && hand.holds && hand.drag !== 'ruler');
  wanted = false;
  draw(moving);
  controls();
  drawing.moved = moving;
  if (goesOn) ask();
  else if (moving) drawing.rest = setTimeout(ask, 150);
}
function ask() {
  clearTimeout(drawing?.rest);
  if (wanted || !drawing) return;
  wanted = true;
  requestAnimationFrame(frame);
}

function controls() {
  const {azimuth, elevation} = state.light, d = directionOf(state.light);
  at('light').setAttribute('cx', 50 + 46 * d[0]);
  at('light').setAttribute('cy', 50 - 46 * d[1]);
  at('angles').textContent = `${Math.round((azimuth + 360) % 360)}° · ${Math.round(elevation)}° high`;
  at('dome').setAttribute('aria-valuetext', `azimuth ${Math.round((azimuth + 360) % 360)}, elevation ${Math.round(elevation)} degrees`);
  for (const button of at('tools').children) button.setAttribute('aria-pressed', button.dataset.tool === state.tool);
  for (const key of ['shadows', 'loupe', 'sweeping']) at(key).setAttribute('aria-pressed', state[key]);
  at('look').value = state.look;
  at('exposure').value = state.exposure;
  canvas.style.cursor = {light: 'crosshair', tilt: 'grab', pan: 'move', ruler: 'crosshair'}[state.tool];
  ruler();
  scaleBar();
}
const millimetres = mm => mm >= 1000 ? `${(mm / 1000).toFixed(2)} m` : mm >= 100 ? `${mm.toFixed(0)} mm` : `${mm.toFixed(mm >= 10 ? 1 : 2)} mm`;
const length = pixels => data.scale_known ? millimetres(pixels * data.mm_per_pixel) : `${pixels.toFixed(pixels < 10 ? 1 : 0)} pixels`;

function ruler() {
  at('ruler').style.display = state.ruler ? '' : 'none';
  if (!state.ruler) return;
  const placement = hand.placement(), css = canvas.clientWidth / screen.width;
  const [a, b] = state.ruler.map(p => placement.toScreen(...p).map(v => v * css));
  for (const line of at('ruler').querySelectorAll('line'))
    for (const [name, value] of [['x1', a[0]], ['y1', a[1]], ['x2', b[0]], ['y2', b[1]]]) line.setAttribute(name, value);
  at('distance').textContent = length(Math.hypot(state.ruler[1][0] - state.ruler[0][0], state.ruler[1][1] - state.ruler[0][1]));
  at('distance').setAttribute('x', (a[0] + b[0]) / 2 + 10);
  at('distance').setAttribute('y', (a[1] + b[1]) / 2 - 10);
}
// 1, 2 or 5 times a power of ten, about a tenth of the screen; true where the painting is not tilted.
function scaleBar() {
  const unit = data.scale_known ? data.mm_per_pixel : 1, css = canvas.clientWidth / screen.width;
  const most = 140 / (state.view.zoom * css) * unit, power = 10 ** Math.floor(Math.log10(most));
  const shown = [5, 2, 1].find(n => n * power <= most) * power;
  at('bar').style.width = `${shown / unit * state.view.zoom * css}px`;
  at('bar-length').textContent = data.scale_known ? shown < 1 ? `${+(1000 * shown).toPrecision(1)} µm` : shown >= 1000 ? `${shown / 1000} m` : `${shown} mm` :
    `${+shown.toPrecision(1)} px`;
}

// Rectangles of the screen that the caption and the dome leave free: below both, between them, or below the one and
// beside the other. Where they leave too little, the whole screen.
function free() {
  const stage = canvas.getBoundingClientRect(), toScreen = screen.width / Math.max(stage.width, 1), gap = 8;
  const whole = {x0: 0, y0: 0, x1: screen.width, y1: screen.height};
  const panes = ['caption', 'lighting'].map(id => at(id).getBoundingClientRect()).filter(box => box.width > 0);
  const [caption, lighting] = panes.map(box => ({x0: (box.left - stage.left - gap) * toScreen, x1: (box.right - stage.left + gap) * toScreen,
    y1: (box.bottom - stage.top + gap) * toScreen}));
  if (!lighting) return [whole];
  const candidates = [{...whole, y0: Math.max(caption.y1, lighting.y1)}, {...whole, x0: caption.x1, x1: lighting.x0},
    {...whole, x1: lighting.x0, y0: caption.y1}, {...whole, x0: caption.x1, y0: lighting.y1}];
  const usable = candidates.filter(r => r.x1 - r.x0 > 0.3 * screen.width && r.y1 - r.y0 > 0.3 * screen.height);
  return usable.length ? usable : [whole];
}

function resized() {
  const ratio = Math.min(devicePixelRatio || 1, 3);
  const width = Math.max(1, Math.round(canvas.clientWidth * ratio)), height = Math.max(1, Math.round(canvas.clientHeight * ratio));
  const fits = !placed || state.view.zoom === fittedZoom;
  Object.assign(screen, {width, height});
  if (fits) fit();
  placed = true;
  ask();
}
function fit() {
  state.view = fitted(screen, state.view.turn, free());
  fittedZoom = state.view.zoom;
}

function caption() {
  document.title = data.title;
  at('title').textContent = data.title;
  const size = data.scale_known ? [`${millimetres(data.width * data.mm_per_pixel)} × ${millimetres(data.height * data.mm_per_pixel)}`] : [];
  at('size').textContent = [...size, `${data.width} × ${data.height} pixels`].join(' · ');
  at('credit').textContent = data.credit;
  const {program, version, photographs} = data.origin;
  at('origin').textContent = [photographs > 0 ? `Shape and gloss were fitted from ${photographs} photographs.` : 'Relief and gloss are shown as its maps say.',
    program ? `Made with ${program}${version ? ` ${version}` : ''}.` : ''].join(' ');
}

function setUp() {
  for (const [name, text, help] of toolNames) {
    const button = document.createElement('button');
    Object.assign(button, {textContent: text, title: help, onclick: () => { state.tool = name; ask(); }});
    button.dataset.tool = name;
    at('tools').append(button);
  }
  data.looks.forEach(({name}, value) => at('look').append(new Option(name, value)));
  at('look').onchange = () => { state.look = +at('look').value; ask(); };
  at('exposure').oninput = () => { state.exposure = +at('exposure').value; ask(); };
  for (const key of ['shadows', 'loupe', 'sweeping']) at(key).onclick = () => { state[key] = !state[key]; ask(); };
  at('shadows').hidden = data.horizon[0] === 0;
  for (const [id, key] of [['fit', 'f'], ['one', '1'], ['straight', 'r']]) at(id).onclick = () => { hand.key({key}); ask(); };
  at('full').hidden = !document.fullscreenEnabled;
  at('full').onclick = () => document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen?.();
  at('link').onclick = () => {
    location.replace(link());
    navigator.clipboard?.writeText(location.href).then(() => { at('said').textContent = 'The link to this view has been copied.'; }, () => {});
  };
  at('more').onclick = () => at('more').setAttribute('aria-expanded', at('more').getAttribute('aria-expanded') !== 'true');
  window.addEventListener('hashchange', () => { readLink(); ask(); });
  const aim = event => {
    const box = at('dome').getBoundingClientRect(), x = (event.clientX - box.left) / box.width, y = (event.clientY - box.top) / box.height;
    state.sweeping = false;
    state.light = lightAt((x - 0.5) / 0.46, (0.5 - y) / 0.46);
    ask();
  };
  at('dome').addEventListener('pointerdown', event => { at('dome').setPointerCapture(event.pointerId); aim(event); });
  at('dome').addEventListener('pointermove', event => { if (event.buttons) aim(event); });
  document.addEventListener('keydown', event => {
    if (event.target.closest('button, select, input, summary') || !hand.key(event)) return;
    event.preventDefault();
    ask();
  });
  canvas.addEventListener('webglcontextlost', event => event.preventDefault());
  canvas.addEventListener('webglcontextrestored', () => location.reload());
  new ResizeObserver(resized).observe(canvas);
}

const hand = new InputController(canvas, state, () => screen, fit, ask);
try {
  caption();
  placed = readLink();
  // Twice what the screen shows at once, in megabytes: a tile has one.
  const pixels = canvas.clientWidth * canvas.clientHeight * Math.min(devicePixelRatio || 1, 3) ** 2;
  drawing = new Drawing(canvas, clamp(Math.round(5 * pixels / tileSide ** 2) + 24, 64, 512), ask,
    name => { at('said').textContent = `${name} could not be loaded; it is tried again.`; });
  setUp();
} catch (error) {
  document.body.classList.add('failed');
  at('failed').hidden = false;
  console.error(error);
}
