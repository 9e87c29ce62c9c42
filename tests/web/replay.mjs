// replay.mjs: a journal painted by the web engine in Node, as its worker does it.
// Usage: node replay.mjs APP_FOLDER CHOICE.json JOURNAL.jsonl [LINES_AT_ONCE [MEMORY_BYTES]]
// Writes {"canvas", "look", "texels": hashes, "seconds", "bristle_pixels", "memory"} to stdout. LINES_AT_ONCE: what changed is looked at
// after so many lines (0: at the end only). MEMORY_BYTES: so much is taken before there is anything in it.
import {createHash} from 'node:crypto';
import {readFileSync} from 'node:fs';
import {engineOf} from './node_engine.mjs';

const [folder, choicePath, journalPath, linesAtOnce = '0', memoryBytes = '0'] = process.argv.slice(2), engine = await engineOf(folder);
engine.memory(Number(memoryBytes));
const {width, height} = engine.open(JSON.parse(readFileSync(choicePath, 'utf8')));
const lines = readFileSync(journalPath, 'utf8').split('\n').filter(line => line.trim());
engine.begin(lines[0]);
const begin = performance.now(), every = Number(linesAtOnce);
lines.slice(1).forEach((line, i) => {
  engine.apply(line);
  if (every && i % every === 0) engine.refresh(false);
});
const seconds = (performance.now() - begin) / 1000;
const hashes = engine.json('hash'), texels = engine.texels(0, {x0: 0, y0: 0, x1: width, y1: height});
console.log(JSON.stringify({...hashes, texels: createHash('sha256').update(texels).digest('hex'), seconds, ...engine.json('totals'), memory: engine.memory().length}));
