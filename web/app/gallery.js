// gallery.js: the works on this device.

import {ask, at, element, icon} from './controls.js';

const when = new Intl.DateTimeFormat(undefined, {dateStyle: 'medium'});
const megabytes = bytes => bytes < 1e6 ? 'less than 1 MB' : bytes < 1e9 ? `${Math.round(bytes / 1e6)} MB` : `${(bytes / 1e9).toFixed(1)} GB`;

// on: {open(work), create(), removed(work)}.
export async function showGallery(storage, on) {
  const works = await storage.works(), {persists, used, left, low} = await storage.room();
  at('kept').textContent = works.length === 0 ? 'Paint in oil, and tilt the tablet: the light plays over the strokes.' :
    low ? `The storage of this device is nearly full (${megabytes(Math.max(left, 0))} left): take works along, and remove some.` :
      `${works.length === 1 ? 'One painting' : `${works.length} paintings`}, kept on this device${persists ? '' : ' as long as the browser does not clear it'}: ${megabytes(used)}.`;
  const create = element('li', {className: 'new'}, element('button', {type: 'button', className: 'open', onclick: on.create},
    element('span', {className: 'face'}, icon('plus')), element('span', {className: 'name', textContent: 'New painting'}), element('span', {className: 'line', textContent: 'canvas, panel, paper, a picture'})));
  at('works').replaceChildren(create, ...await Promise.all(works.map(work => card(storage, work, on))));
}

async function card(storage, work, on) {
  const blob = await storage.picture(work.id, 'thumbnail'), face = element('span', {className: 'face'});
  if (blob) {
    const url = URL.createObjectURL(blob);
    face.append(element('img', {src: url, alt: '', onload: () => URL.revokeObjectURL(url)}));
  }
  const remove = element('button', {type: 'button', 'aria-label': `Remove ${work.title}`, title: 'Remove', onclick: async () => {
    const yes = await ask(`Remove “${work.title}”?`, 'It is gone from this device for good. Its journal can be taken along first.', [[null, 'Keep'], [true, 'Remove for good', 'danger']]);
    if (!yes) return;
    await storage.remove(work.id);
    await on.removed(work);
    showGallery(storage, on);
  }}, icon('close'));
  return element('li', {}, element('button', {type: 'button', className: 'open', onclick: () => on.open(work)}, face, element('span', {className: 'name', textContent: work.title})),
    element('span', {className: 'line'}, element('span', {textContent: when.format(work.changed)}), remove));
}
