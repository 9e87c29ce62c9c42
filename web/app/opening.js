// opening.js: a work onto the engine: as its memory was kept (memory_image.js), or on its support from its first stroke on.

import {busy} from './controls.js';
import {decoded} from './new_painting.js';

// What the engine is given of a work's support.
async function supportOf(storage, {id, choice}) {
  const picture = choice.picture ? await decoded(await storage.picture(id, 'ground'), Infinity) : null;
  const relief = choice.height_from === 'picture' ? await storage.picture(id, 'relief') : null;
  return {choice, picture, relief: relief && await decoded(relief, Infinity, picture)};
}
async function onSupport(storage, connection, record) {
  const file = await storage.original(record), support = await supportOf(storage, record);
  if (file) busy('Reading the painting file…', 0);
  return {...await connection.ask('open', {work: record.id, file, ...support}), brush: null, next: 0};
}

// Promises {picture, paints, state, brush, head}; `next`: the number of the record that comes next; `again`: how many were painted
// again.
export async function ontoEngine(storage, connection, record) {
  const {id, choice} = record, {next} = await storage.journal(id);
  const recalled = next ? await connection.ask('recall', {work: id, choice, next}) : null;
  const begun = recalled ?? await onSupport(storage, connection, record), {text} = await storage.journal(id, begun.next);
  if (!text) return {...begun, next, again: 0};
  busy('Painting what is kept…', 0);
  const {told, state, brush} = await connection.ask('replay', {text, next});
  if (told.length) console.info(told.join('\n'));
  return {...begun, state, brush, next, again: next - begun.next};
}
// The work that is open on a ground of the same relief that looks otherwise. Promises {picture, head}.
export const ontoGround = async (storage, connection, record) => connection.ask('lieOn', await supportOf(storage, record));
