// node_engine.mjs: the web engine of an application's folder in Node, as its worker has it.
import {readFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {dirname, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

export async function engineOf(folder) {
  const app = resolve(folder);
  // Emscripten's module of 3.1.6 expects these of Node.
  globalThis.require = createRequire(import.meta.url);
  globalThis.__dirname = dirname(resolve(app, 'engine.mjs'));
  const {Engine} = await import(pathToFileURL(resolve(app, 'engine.js')));
  const {default: make} = await import(pathToFileURL(resolve(app, 'engine.mjs')));
  return Engine.load(() => make({wasmBinary: readFileSync(resolve(app, 'engine.wasm'))}));
}
