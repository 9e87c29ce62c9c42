// serve.mjs: a folder on http://localhost, with the headers that a server should send (docs/guide/tablet.md).
// Usage: node web/serve.mjs FOLDER [PORT]
import {createServer} from 'node:http';
import {readFile} from 'node:fs/promises';
import {extname, join, normalize, resolve} from 'node:path';

const folder = resolve(process.argv[2] ?? 'build/web/app'), port = Number(process.argv[3] ?? 8080);
const types = {'.html': 'text/html; charset=utf-8', '.js': 'text/javascript', '.mjs': 'text/javascript', '.css': 'text/css', '.wasm': 'application/wasm',
  '.svg': 'image/svg+xml', '.png': 'image/png', '.webmanifest': 'application/manifest+json', '.json': 'application/json'};

const server = createServer(async (request, response) => {
  const path = normalize(decodeURIComponent(new URL(request.url, 'http://localhost').pathname));
  const file = join(folder, path.endsWith('/') ? `${path}index.html` : path);
  const headers = {'Cross-Origin-Opener-Policy': 'same-origin', 'Cross-Origin-Embedder-Policy': 'require-corp', 'X-Content-Type-Options': 'nosniff', 'Cache-Control': 'no-cache'};
  try {
    if (!file.startsWith(folder)) throw new Error('outside');
    const bytes = await readFile(file);
    response.writeHead(200, {...headers, 'Content-Type': types[extname(file)] ?? 'application/octet-stream'});
    response.end(bytes);
  } catch {
    response.writeHead(404, headers);
    response.end('There is no such file.');
  }
});
server.listen(port, '127.0.0.1', () => console.log(`http://localhost:${server.address().port}/`));
