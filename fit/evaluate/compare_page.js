'use strict';
const report = JSON.parse(document.getElementById('report').textContent);
const photos = report.photos, at = id => document.getElementById(id);

// An element with attributes and children; strings become text, never markup.
function make(tag, attributes = {}, ...children) {
  const svg = ['svg', 'circle', 'line', 'text', 'title', 'g', 'rect', 'path'].includes(tag);
  const element = svg ? document.createElementNS('http://www.w3.org/2000/svg', tag) : document.createElement(tag);
  for (const [key, value] of Object.entries(attributes))
    if (key.startsWith('on')) element.addEventListener(key.slice(2), value);
    else if (value !== false && value !== null) element.setAttribute(key, value === true ? '' : value);
  element.append(...children);
  return element;
}
const fixed = (value, digits) => value === null || value === undefined ? '–' : value.toFixed(digits).replace('-', '−');
const signed = (value, digits) => (value > 0 ? '+' : '') + fixed(value, digits);
const psnr = value => value >= 100 ? '≥ 100' : fixed(value, 1);
const badge = photo => make('span', {class: photo.fitted ? 'badge' : 'badge held'}, photo.fitted ? 'fitted' : 'held out');
const count = (n, what) => `${n} ${what}${n === 1 ? '' : 's'}`;

function colour(scale, t) {
  const stops = report.scales[scale], x = Math.min(Math.max(t, 0), 1) * (stops.length - 1), i = Math.min(Math.floor(x), stops.length - 2);
  const part = (hex, k) => parseInt(hex.slice(1 + 2 * k, 3 + 2 * k), 16);
  return `rgb(${[0, 1, 2].map(k => Math.round(part(stops[i], k) * (1 - x + i) + part(stops[i + 1], k) * (x - i)))})`;
}
function legend(l, ends) {
  const marks = make('div', {class: 'marks num'}, ...l.ticks.map((tick, i) =>
    make('span', {style: `left:${100 * tick.at}%`}, tick.label.replace('-', '−'),
      ...(i === l.ticks.length - 1 && l.unit ? [make('i', {}, l.unit)] : []))));
  const ramp = make('div', {class: 'ramp', style: `background:linear-gradient(90deg,${report.scales[l.scale]})`});
  return make('div', {class: 'legend'}, ramp, marks, ...(ends ? [make('div', {class: 'ends'}, ...ends.map(e => make('span', {}, e)))] : []));
}

function summary() {
  const {held_out: held, fitted} = report.mean;
  at('lead').textContent = `${count(photos.length, 'photograph')}, ${report.width} × ${report.height} pixels: ${fitted.count} fitted, ` +
    `${held.count} held out. Numbers compare the values as the photographs store them (${report.transfer}).`;
  const main = held.count ? held : fitted, what = held.count ? 'held out' : 'fitted';
  const card = (title, key, show, unit, meaning) => make('div', {class: 'card'}, make('h3', {}, title),
    make('div', {class: 'big num'}, show(main[key]), ' ', make('small', {}, unit + what)),
    make('dl', {class: 'num'}, ...[['fitted', fitted[key]], ['all', report.mean.all[key]]].filter(([n]) => n !== what)
      .concat(key in main && `faithful_${key}` in main ? [['faithful mode, ' + what, main[`faithful_${key}`]]] : []).map(([name, value]) =>
      make('div', {}, make('dt', {}, name + ' '), make('dd', {}, show(value))))),
    make('div', {class: 'soft small'}, meaning));
  at('metrics').append(
    card('PSNR, mean', 'psnr_db', psnr, 'dB · ', 'Size of the error in all. More is better: 30 dB is an error of 3 % of full scale, 40 dB of 1 %.'),
    card('SSIM, mean', 'ssim', v => fixed(v, 3), '', 'Likeness of fine structure such as brushwork and cracks. 1 is the same; 0 is nothing in common.'),
    card('ΔE2000, mean', 'delta_e_2000', v => fixed(v, 1), '', 'Colour difference as the eye sees it. About 1 is just visible side by side; above 5 is plain.'));
  const notes = report.warnings.slice();
  if (!held.count) notes.unshift('No photograph was held out: these numbers say how well the fit repeats what it has seen, not how well it predicts new light.');
  at('notes').hidden = notes.length === 0;
  at('notes').append(...notes.map(note => make('p', {}, note)));
}

const modes = [['wipe', 'Wipe'], ['pair', 'Side by side'], ['blink', 'Blink'], ['error', 'Error'], ['delta_e', 'ΔE2000']];
const ratio = report.width / report.height;
const worst = list => photos.indexOf(list.reduce((a, b) => b.psnr_db < a.psnr_db ? b : a));
const unseen = photos.filter(p => !p.fitted);
let mode = 'wipe', chosen = worst(unseen.length ? unseen : photos), order = photos.map((_, i) => i);
let wiped = 50, blinking = null, flip = () => {};

function picture(kind, words) { return make('img', {src: photos[chosen].pictures[kind], alt: words, draggable: 'false'}); }
function frame(kind, width, ...children) {
  return make('div', {class: 'frame ' + kind, style: `aspect-ratio:${width * ratio};width:min(100%, calc(74vh * ${width * ratio}))`}, ...children);
}
function show_wipe() {
  const relit = picture('relit', 'Relit painting'), bar = make('div', {class: 'bar'});
  const slider = make('input', {type: 'range', min: 0, max: 100, step: .1, 'aria-label': 'Part of the picture that shows the photograph',
    oninput: () => set(Number(slider.value))});
  const set = percent => {
    wiped = Math.min(Math.max(percent, 0), 100);
    relit.style.clipPath = `inset(0 0 0 ${wiped}%)`; bar.style.left = wiped + '%'; slider.value = wiped;
  };
  const box = frame('wipe', 1, picture('photo', 'Photograph'), relit, bar, make('span', {class: 'tag l'}, 'photograph'), make('span', {class: 'tag r'}, 'relit'));
  const drag = event => { const r = box.getBoundingClientRect(); set(100 * (event.clientX - r.left) / r.width); };
  box.addEventListener('pointerdown', event => { box.setPointerCapture(event.pointerId); drag(event); });
  box.addEventListener('pointermove', event => { if (event.buttons) drag(event); });
  set(wiped);
  return [box, slider];
}
function show_pair() {
  const half = (kind, words) => make('figure', {}, picture(kind, words), make('span', {class: 'tag l'}, words.toLowerCase()));
  const box = frame('two', 2, half('photo', 'Photograph'), half('relit', 'Relit'));
  box.style.aspectRatio = 'auto';
  for (const image of box.querySelectorAll('img')) image.style.aspectRatio = ratio;
  return [box, ''];
}
function show_blink() {
  const relit = picture('relit', 'Relit painting'), tag = make('span', {class: 'tag l'}, 'photograph');
  flip = () => { const hide = relit.style.visibility !== 'hidden'; relit.style.visibility = hide ? 'hidden' : 'visible'; tag.textContent = hide ? 'photograph' : 'relit'; };
  flip();
  const start = () => { blinking = setInterval(() => flip(), 700); button.textContent = 'Hold'; };
  const stop = () => { clearInterval(blinking); blinking = null; button.textContent = 'Blink on'; };
  const button = make('button', {onclick: () => blinking ? stop() : start()}, 'Hold');
  start();
  return [frame('', 1, picture('photo', 'Photograph'), relit, tag), button];
}
const show_error = () => [frame('', 1, picture('error', 'Map of the error in brightness')),
  legend(report.legends.error, ['relit too dark', 'brightness, of full scale', 'relit too bright'])];
const show_delta_e = () => [frame('', 1, picture('delta_e', 'Map of the colour difference')), legend(report.legends.delta_e, ['same colour', 'this different, or more'])];
const ways = {wipe: show_wipe, pair: show_pair, blink: show_blink, error: show_error, delta_e: show_delta_e};

function show() {
  const photo = photos[chosen];
  clearInterval(blinking); blinking = null; flip = () => {};
  at('name').textContent = photo.name;
  at('use').replaceChildren(badge(photo));
  at('place').textContent = `${order.indexOf(chosen) + 1 || '–'} / ${order.length}`;
  const [stage, under] = ways[mode]();
  at('stage').replaceChildren(stage); at('under').replaceChildren(under);
  for (const button of at('modes').children) button.setAttribute('aria-pressed', button.dataset.mode === mode);
  const facts = [['Light', `${fixed(photo.elevation_deg, 0)}° up, from ${fixed(photo.azimuth_deg, 0)}°`], ['PSNR', psnr(photo.psnr_db) + ' dB'],
    ['SSIM', fixed(photo.ssim, 3)], ['ΔE2000, mean', fixed(photo.delta_e_2000, 1)], ['ΔE2000, 95 % below', fixed(photo.delta_e_2000_p95, 1)],
    ['Brightness error', signed(100 * photo.bias, 1) + ' %']];
  at('facts').replaceChildren(...facts.flatMap(([name, value]) => [make('dt', {}, name), make('dd', {}, value)]));
  for (const row of at('rows').children) row.setAttribute('aria-selected', Number(row.dataset.index) === chosen);
  const dot = at('sky').querySelector(`[data-index="${chosen}"]`), ring = at('sky').querySelector('.chosen');
  ring.setAttribute('cx', dot.getAttribute('cx')); ring.setAttribute('cy', dot.getAttribute('cy'));
  for (const near of [step(1), step(-1)]) for (const kind of ['photo', 'relit']) new Image().src = photos[near].pictures[kind];
}
const step = by => order.length ? order[(order.indexOf(chosen) + by + order.length) % order.length] : chosen;
function choose(index, scroll) {
  chosen = index; show();
  if (!scroll) return;
  const row = at('rows').querySelector('[aria-selected="true"]'), box = row && row.closest('.scroll');  // the page itself stays put
  if (row && (row.offsetTop < box.scrollTop + 40 || row.offsetTop + row.offsetHeight > box.scrollTop + box.clientHeight))
    box.scrollTop = row.offsetTop - box.clientHeight / 2;
}

function sky() {
  const radius = 138, cx = 160, cy = 156, values = photos.map(p => p.psnr_db);
  const lo = Math.floor(Math.min(...values)), hi = Math.max(Math.ceil(Math.max(...values)), lo + 1);
  const svg = at('sky');
  const spots = photos.map(photo => {
    const r = radius * (90 - photo.elevation_deg) / 90, turn = photo.azimuth_deg * Math.PI / 180;
    return [cx + r * Math.cos(turn), cy - r * Math.sin(turn)];
  });
  const free_label = (r, words) => {  // on the ring, where no dot is near
    const places = [...Array(24).keys()].map(i => [cx + r * Math.cos(i * Math.PI / 12), cy - r * Math.sin(i * Math.PI / 12)]);
    const room = ([x, y]) => Math.min(...spots.map(([u, v]) => Math.hypot(x - u, y - v)));
    const [x, y] = places.reduce((a, b) => room(b) > room(a) ? b : a);
    svg.append(make('text', {x, y: y + 4, 'text-anchor': 'middle'}, words));
  };
  for (const elevation of [0, 30, 60]) {
    const r = radius * (90 - elevation) / 90;
    svg.append(make('circle', {class: 'grid', cx, cy, r}));
    if (elevation) free_label(r, elevation + '°');
  }
  svg.append(make('line', {class: 'grid', x1: cx - radius, y1: cy, x2: cx + radius, y2: cy}), make('line', {class: 'grid', x1: cx, y1: cy - radius, x2: cx, y2: cy + radius}));
  photos.forEach((photo, index) => {
    const place = {cx: spots[index][0].toFixed(1), cy: spots[index][1].toFixed(1)};
    const words = `${photo.name}, ${photo.fitted ? 'fitted' : 'held out'}, ${psnr(photo.psnr_db)} dB`;
    svg.append(make('circle', {class: 'dot', ...place, r: 6.5, fill: colour('sequential', (photo.psnr_db - lo) / (hi - lo)), 'data-index': index,
      role: 'button', tabindex: 0, 'aria-label': words, onclick: () => choose(index, true),
      onkeydown: event => { if (event.key === 'Enter') choose(index, true); }}, make('title', {}, words)));
    if (!photo.fitted) svg.append(make('circle', {class: 'held', ...place, r: 8.5}));
  });
  svg.append(make('circle', {class: 'chosen', cx, cy, r: 12}));
  for (let i = 0; i < 60; ++i) svg.append(make('rect', {x: 60 + i * 200 / 60, y: 316, width: 200 / 60 + .5, height: 9, fill: colour('sequential', i / 59)}));
  svg.append(make('text', {x: 60, y: 341, 'text-anchor': 'middle'}, String(lo)), make('text', {x: 160, y: 341, 'text-anchor': 'middle'}, 'PSNR'),
    make('text', {x: 260, y: 341, 'text-anchor': 'middle'}, hi + ' dB'));
  at('sky-note').textContent = 'Where each light stood, seen from the camera: straight on in the middle, grazing at the rim. Ringed lights were held out.';
}

const columns = [['Photograph', p => p.name, p => p.name], ['Use', p => p.fitted ? 1 : 0, badge], ['Elevation', p => p.elevation_deg, p => fixed(p.elevation_deg, 1) + '°'],
  ['Azimuth', p => p.azimuth_deg, p => fixed(p.azimuth_deg, 1) + '°'], ['PSNR, dB', p => p.psnr_db, p => psnr(p.psnr_db)], ['SSIM', p => p.ssim, p => fixed(p.ssim, 3)],
  ['ΔE2000', p => p.delta_e_2000, p => fixed(p.delta_e_2000, 2)], ['ΔE 95 %', p => p.delta_e_2000_p95, p => fixed(p.delta_e_2000_p95, 2)],
  ['Brightness error', p => p.bias, p => signed(100 * p.bias, 1) + ' %']];
let sorted = null, falling = false, filter = 'all';
function table() {
  const kept = photos.map((_, i) => i).filter(i => filter === 'all' || photos[i].fitted === (filter === 'fitted'));
  if (sorted !== null) {
    const key = columns[sorted][1];
    const compare = (a, b) => typeof a === 'string' ? a.localeCompare(b, undefined, {numeric: true}) : a - b;
    kept.sort((i, j) => (falling ? -1 : 1) * compare(key(photos[i]), key(photos[j])) || i - j);
  }
  order = kept;
  at('rows').replaceChildren(...order.map(index => make('tr', {'data-index': index, onclick: () => choose(index)},
    ...columns.map(([, , show_it], c) => make('td', {class: c > 1 ? 'n' : '', title: c ? null : photos[index].name}, c ? show_it(photos[index]) : make('button', {}, photos[index].name))))));
  at('columns').replaceChildren(...columns.map(([title], c) => make('th', {class: c > 1 ? 'n' : '', scope: 'col', 'aria-sort': sorted === c ? (falling ? 'descending' : 'ascending') : 'none'},
    make('button', {onclick: () => { falling = sorted === c && !falling; sorted = c; table(); show(); at('columns').children[c].firstChild.focus(); }}, title + (sorted === c ? (falling ? ' ↓' : ' ↑') : '')))));
  for (const button of at('filters').children) button.setAttribute('aria-pressed', button.dataset.filter === filter);
}

function maps() {
  for (const map of report.maps || [])
    at('maps').append(make('figure', {class: 'card'}, make('img', {src: map.picture, alt: map.title, loading: 'lazy', style: `aspect-ratio:${ratio}`}),
      ...(map.legend ? [legend(map.legend)] : []), make('figcaption', {}, make('strong', {}, map.title), ' ' + map.symbol, make('br'), make('span', {class: 'soft'}, map.meaning))));
}

summary(); sky(); maps();
at('modes').append(...modes.map(([key, title]) => make('button', {'data-mode': key, onclick: () => { mode = key; show(); }}, title)));
at('filters').append(...[['all', 'All'], ['held', 'Held out'], ['fitted', 'Fitted']].map(([key, title]) =>
  make('button', {'data-filter': key, onclick: () => { filter = key; table(); show(); }}, title)));
at('previous').addEventListener('click', () => choose(step(-1), true));
at('next').addEventListener('click', () => choose(step(1), true));
at('how').textContent = `PSNR, SSIM and the brightness error (mean of relit minus photograph, of full scale) are computed from the values as stored (${report.transfer}); ΔE2000 (CIE DE2000, white D65) from linear light. ` +
  'Pictures on this page are converted to sRGB for the screen, so those of linear photographs look brighter here than in other programs. ' +
  `Each relit picture is the painting under the light of its photograph, ${report.options.cast_shadows ? 'with' : 'without'} cast shadows. ` +
  'Held-out photographs took no part in the fit: they alone show how well new light is predicted. Pixels that were not measured do not count.';
addEventListener('keydown', event => {
  if (event.ctrlKey || event.altKey || event.metaKey) return;
  const typing = event.target.matches('input'), pressing = event.target.matches('button, [role="button"]');
  if (event.key === 'ArrowLeft' && !typing) choose(step(-1), true);
  else if (event.key === 'ArrowRight' && !typing) choose(step(1), true);
  else if (event.key >= '1' && event.key <= '5') { mode = modes[event.key - 1][0]; show(); }
  else if (event.key === ' ' && mode === 'blink' && !pressing) flip();
  else return;
  event.preventDefault();
});
const wanted = new URLSearchParams(location.hash.slice(1));  // compare.html#photo=3&mode=error
if (ways[wanted.get('mode')]) mode = wanted.get('mode');
if (photos[wanted.get('photo')]) chosen = Number(wanted.get('photo'));
table(); show();
