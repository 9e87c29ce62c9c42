// page.js: the page: controls, what is drawn when, links to a view.

const at = id => document.getElementById(id), canvas = at('picture');
const toolNames = [['light', 'Light', 'drag: move the lamp over the painting (L)'], ['tilt', 'Tilt', 'drag: tilt the painting (T)'],
  ['pan', 'Move', 'drag: move the painting (H); two fingers or the wheel zoom'], ['ruler', 'Measure', 'drag: measure a distance (M)']];
const state = {
  view: {x: (data.width - 1) / 2, y: (data.height - 1) / 2, zoom: 1, turn: 0}, tilt: {x: 0, y: 0, vx: 0, vy: 0, returning: false},
  light: {azimuth: data.light_deg[0], elevation: data.light_deg[1]}, tool: 'light', look: 0, shadows: true, sweeping: false,
  loupe: false, ruler: null, exposure: 0, ambient: 0.03, shoulder: 0.15, ui: true,
};
const screen = {width: 1, height: 1};
let drawing, scale = 1, wanted = false, frameTime = 0, placed = false;

// A link holds what it shows: #azimuth=135&elevation=20&look=1&x=…&y=…&zoom=…; zoom=fit where it is left out.
const linked = {azimuth: ['light', 'azimuth'], elevation: ['light', 'elevation'], tilt_x: ['tilt', 'x'], tilt_y: ['tilt', 'y'], x: ['view', 'x'],
  y: ['view', 'y'], zoom: ['view', 'zoom'], turn: ['view', 'turn'], look: ['look'], exposure: ['exposure'], ambient: ['ambient'], shoulder: ['shoulder']};
function readLink() {
  const words = new URLSearchParams(location.hash.slice(1));
  for (const [name, [key, inner]] of Object.entries(linked)) {
    const value = parseFloat(words.get(name));
    if (!Number.isFinite(value)) continue;
    if (inner) state[key] = {...state[key], [inner]: value};
    else state[key] = value;
  }
  state.look = clamp(Math.round(state.look), 0, data.looks.length - 1);
  state.view.zoom = clamp(state.view.zoom, 1 / 1024, 64);
  for (const key of ['shadows', 'ui']) if (words.has(key)) state[key] = words.get(key) !== '0';
  if (toolNames.some(([name]) => name === words.get('tool'))) state.tool = words.get('tool');
  return words.has('zoom');
}
function link() {
  const words = Object.entries(linked).map(([name, [key, inner]]) => [name, +(inner ? state[key][inner] : state[key]).toFixed(4)]);
  const hash = new URLSearchParams([...words, ['shadows', +state.shadows], ['tool', state.tool]]).toString();
  return `${location.href.split('#')[0]}#${hash}`;
}

function scene(placement) {
  const look = data.looks[state.look];
  return {light: placement.inSurface(directionOf(state.light)), look: state.look, shadows: state.shadows, ambient: state.ambient,
    exposure: state.exposure, shoulder: state.shoulder, strength: look === 'Specular enhancement' ? 0.7 : 2.1,
    sharpness: look === 'Unsharp normals' ? 3 : 40};
}

function draw(moving) {
  const placement = hand.placement(), part = moving ? scale : 1, looks = scene(placement), seen = placement.seen();
  const width = Math.max(1, Math.round(screen.width * part)), height = Math.max(1, Math.round(screen.height * part));
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, {width, height});
  const {tiles} = drawing, level = tiles.affordable(placement.level(part), seen), views = [{level, seen}];
  if (data.looks[state.look] === 'Unsharp normals') views.push({level: Math.min(level + 3, data.levels - 1), seen});
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
  at('lamp').setAttribute('cx', 50 + 46 * d[0]);
  at('lamp').setAttribute('cy', 50 - 46 * d[1]);
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

function resized() {
  const ratio = Math.min(devicePixelRatio || 1, 3);
  const width = Math.max(1, Math.round(canvas.clientWidth * ratio)), height = Math.max(1, Math.round(canvas.clientHeight * ratio));
  const fits = !placed || Math.abs(state.view.zoom / fitted(screen, state.view.turn).zoom - 1) < 1e-6;
  Object.assign(screen, {width, height});
  if (fits) state.view = {...fitted(screen, state.view.turn)};
  placed = true;
  ask();
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
  data.looks.forEach((name, value) => at('look').append(new Option(name, value)));
  at('look').onchange = () => { state.look = +at('look').value; ask(); };
  at('exposure').oninput = () => { state.exposure = +at('exposure').value; ask(); };
  for (const key of ['shadows', 'loupe', 'sweeping']) at(key).onclick = () => { state[key] = !state[key]; ask(); };
  at('shadows').hidden = data.horizon[0] === 0;
  for (const [id, key] of [['fit', 'f'], ['one', '1'], ['straight', 'r']]) at(id).onclick = () => { hand.key({key}); ask(); };
  at('full').onclick = () => document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen?.();
  at('link').onclick = () => {
    location.replace(link());
    navigator.clipboard?.writeText(location.href).then(() => { at('said').textContent = 'The link to this view has been copied.'; }, () => {});
  };
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

const hand = new Hand(canvas, state, () => screen, ask);
try {
  caption();
  const given = readLink();
  if (!given) Object.assign(state.view, fitted({width: canvas.clientWidth, height: canvas.clientHeight}));
  placed = given;
  document.body.classList.toggle('bare', !state.ui);
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
