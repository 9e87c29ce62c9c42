// service_worker.js: TangiPaint without a network. All of its files are kept together, as one version. A new version waits until
// no page of the old one is open, so that a work is never half of one and half of the other.

const version = '{{version}}', files = {{files}}, cacheName = `tangipaint-${version}`;

self.addEventListener('install', event => {
  event.waitUntil(caches.open(cacheName).then(cache => cache.addAll(files.map(file => new Request(file, {cache: 'no-cache'})))));
});
self.addEventListener('activate', event => {
  event.waitUntil((async () => {
    for (const name of await caches.keys()) if (name.startsWith('tangipaint-') && name !== cacheName) await caches.delete(name);
    await self.clients.claim();
  })());
});
self.addEventListener('fetch', event => {
  const url = new URL(event.request.url);
  if (event.request.method !== 'GET' || url.origin !== self.location.origin) return;
  event.respondWith(caches.open(cacheName).then(async cache => await cache.match(event.request, {ignoreSearch: true}) ?? fetch(event.request)));
});
