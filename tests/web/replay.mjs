// replay.mjs: a journal painted by the web engine in Node, as its worker does it.
// Usage: node replay.mjs APP_FOLDER CHOICE.json JOURNAL.jsonl [LINES_AT_ONCE]
// Writes {"canvas", "look": hashes, "seconds", "bristle_pixels", "memory"} to stdout. LINES_AT_ONCE: what changed is looked at
// after so many lines (0: at the end only).
import {readFileSync} from 'node:fs';
import {engineOf} from './node_engine.mjs';

const [folder, choicePath, journalPath, linesAtOnce = '0'] = process.argv.slice(2), engine = await engineOf(folder);
engine.open(JSON.parse(readFileSync(choicePath, 'utf8')));
const lines = readFileSync(journalPath, 'utf8').split('\n').filter(line => line.trim());
engine.begin(lines[0]);
const begin = performance.now(), every = Number(linesAtOnce);
lines.slice(1).forEach((line, i) => {
  engine.apply(line);
  if (every && i % every === 0) engine.refresh(false);
});
const seconds = (performance.now() - begin) / 1000;
console.log(JSON.stringify({...engine.json('hash'), seconds, ...engine.json('totals'), memory: engine.memory().length}));
