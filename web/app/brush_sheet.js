// brush_sheet.js: which tool, how large, how full, how it is pressed.

import {choice, element, icon, slider, toggle} from './controls.js';

const tools = [['round', 'Round'], ['flat', 'Flat'], ['filbert', 'Filbert'], ['fan', 'Fan'], ['knife', 'Knife'], ['rag', 'Rag'], ['smudge', 'Smudge'], ['scrape', 'Scrape']];
const sources = [['pen', 'Pen'], ['speed', 'Speed'], ['fixed', 'Fixed']];
export const nameOf = preset => tools.find(([name]) => name === preset)?.[1] ?? preset;
export const millimetres = mm => `${mm < 10 ? mm.toFixed(1) : Math.round(mm)} mm`;
const percent = v => `${Math.round(100 * v)} %`;

// tool: what main.js keeps; changed() after each change. limits: {least, most} of the size [mm].
export function fillBrushSheet(sheet, tool, limits, changed) {
  const grid = element('div', {className: 'tools', role: 'group', 'aria-label': 'Tool'});
  const marked = () => { for (const each of grid.children) each.setAttribute('aria-pressed', each.dataset.tool === tool.preset); };
  for (const [preset, label] of tools)
    grid.append(element('button', {type: 'button', 'data-tool': preset, 'aria-pressed': 'false', onclick: () => {
      Object.assign(tool, {preset, erasing: false});
      marked();
      changed();
    }}, icon(preset), element('span', {textContent: label})));
  marked();
  const put = (key, of = tool) => v => { of[key] = v; changed(); };
  sheet.append(grid,
    slider({label: 'Size', from: limits.least, to: limits.most, value: tool.size, words: millimetres, changed: put('size'), logarithmic: true}),
    slider({label: 'Load', from: 0.05, to: 1.5, value: tool.load, words: percent, changed: put('load')}),
    element('h3', {textContent: 'Pressure comes from'}),
    choice('Pressure comes from', sources, tool.pressure.from, put('from', tool.pressure)),
    slider({label: 'Strength', from: 0.05, to: 1, value: tool.pressure.value, words: percent, changed: put('value', tool.pressure)}),
    element('p', {className: 'hint', textContent: 'Finger and mouse have no pressure of their own: with “Pen” they press with the strength set here; with “Speed” they press less the faster they move.'}),
    toggle('Dip without washing', tool.dirty, put('dirty')),
    slider({label: 'Stabiliser', from: 0, to: 20, value: tool.stabiliser, words: mm => mm < 0.05 ? 'off' : millimetres(mm), changed: put('stabiliser')}));
}
