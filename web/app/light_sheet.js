// light_sheet.js: where the light is, whether it follows how the tablet is held, and what of the painting is shown.

import {button, choice, element, notice, slider, toggle} from './controls.js';
import {tiltRefusals} from './shared/held.js';
import {aimedOnDome, arrowOf, steppedLight, still} from './shared/moves.js';
import {directionOf} from './shared/placement.js';

const svg = (name, attributes, ...children) => {
  const made = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
};
function dome(state, changed) {
  const sun = svg('circle', {class: 'sun', r: 6}), made = svg('svg', {id: 'dome', viewBox: '0 0 100 100', tabindex: 0, role: 'slider', 'aria-label': 'Light', 'aria-valuemin': 0, 'aria-valuemax': 360},
    svg('circle', {class: 'sky', cx: 50, cy: 50, r: 46}), svg('circle', {class: 'ring', cx: 50, cy: 50, r: 39.8}), svg('circle', {class: 'ring', cx: 50, cy: 50, r: 23}), sun);
  made.show = () => {
    const [x, y] = directionOf(state.light), {azimuth, elevation} = state.light, round = Math.round((azimuth + 360) % 360);
    sun.setAttribute('cx', 50 + 46 * x);
    sun.setAttribute('cy', 50 - 46 * y);
    made.setAttribute('aria-valuenow', round);
    made.setAttribute('aria-valuetext', `from ${round} degrees, ${Math.round(elevation)} degrees high`);
  };
  const aim = event => {
    state.light = aimedOnDome(made, event);
    made.show();
    changed();
  };
  made.addEventListener('pointerdown', event => { made.setPointerCapture(event.pointerId); aim(event); });
  made.addEventListener('pointermove', event => { if (event.buttons) aim(event); });
  made.addEventListener('keydown', event => {
    const arrow = arrowOf(event);
    if (!arrow) return;
    event.preventDefault();
    state.light = steppedLight(state.light, arrow);
    made.show();
    changed();
  });
  made.show();
  return made;
}

// view: View; held: HeldScreen; tool.hand: what one finger does; room: RoomLight; intoRoom(): shows the painting in the room, null where
// the browser cannot; again(): fills the sheet anew.
export function fillLightSheet(sheet, {view, held, tool, room, intoRoom, changed, again}) {
  const {state} = view;
  const follow = async on => {
    if (!on) {
      held.stop();
      state.held = null;
      again();
      changed();
      return;
    }
    const answer = await held.start();
    if (answer !== 'runs') notice(tiltRefusals[answer], true);
    else notice('Tilt the tablet: the light stays where it is in the room.');
    again();
  };
  sheet.append(dome(state, changed),
    toggle('Follow the tablet’s tilt', held.runs, follow));
  if (held.runs) sheet.append(
    choice('The light is', [['false', 'Light in the room'], ['true', 'Light in the hand']], String(Boolean(state.lightInHand)), v => { state.lightInHand = v === 'true'; changed(); }),
    element('div', {className: 'row', style: 'margin-top:10px'}, button('This is level', () => { held.setLevel(); changed(); }, {className: 'button wide'})));
  sheet.append(element('h3', {textContent: 'One finger'}),
    choice('One finger', [['paint', 'Paints'], ['light', 'Light'], ['tilt', 'Tilts'], ['pan', 'Moves']], tool.hand, v => { tool.hand = v; changed(); }),
    slider({label: 'Exposure', from: -3, to: 3, value: state.exposure, words: v => `${v > 0.05 ? '+' : ''}${v.toFixed(1)}`, changed: v => { state.exposure = v; changed(); }}),
    toggle('Cast shadows', state.shadows, v => { state.shadows = v; changed(); if (v) view.loadHorizon(); }));
  const looks = element('select', {'aria-label': 'What is shown', onchange: () => { state.look = Number(looks.value); changed(); }});
  view.picture.looks.forEach(({name}, i) => looks.append(new Option(name, i, false, i === state.look)));
  sheet.append(element('h3', {textContent: 'What is shown'}), looks, element('h3', {textContent: 'The room’s light'}));
  const camera = (label, away) => toggle(label, room.runs && room.away === away, async on => {
    const answer = on ? await room.start(away) : room.stop();
    if (answer) notice(answer, true);
    again();
    changed();
  });
  sheet.append(camera('Light from the camera', false), camera('Camera behind the painting', true),
    element('p', {className: 'hint', textContent: 'The brightest direction that the camera sees becomes the light. Its pictures stay on this page, and are kept nowhere. Behind the painting, the room is what the camera at the tablet’s back sees; where the tilt is followed, the painting stays in its place there.'}),
    ...(intoRoom ? [button('Into the room', intoRoom, {className: 'button wide', title: 'in its true size, on a wall or a table (augmented reality)'}), element('div', {style: 'height:8px'})] : []),
    button('Straighten', () => { Object.assign(state, {tilt: still, view: {...state.view, turn: 0}}); view.fit(); }, {className: 'button wide'}));
}
