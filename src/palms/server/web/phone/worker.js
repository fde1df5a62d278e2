// Keeps the page itself loadable through gaps of the network: the newest when the server answers,
// else what was loaded before. Data (/api/) is never kept.

const STORE = 'palms-phone-1';
const PATIENCE_MS = 3000;
const FILES = [
  './', 'phone.css', 'manifest.webmanifest', 'texts/en.json', 'texts/de.json',
  'bearings.js', 'choose.js', 'guide.js', 'kept.js', 'listen.js', 'live.js', 'main.js', 'other.js',
  'planes.js', 'poses.js', 'preferences.js', 'ring.js', 'rooms.js', 'screens.js', 'settings.js',
  'sketch.js', 'sounds.js', 'speaker.js', 'talk.js', 'texts.js', 'walk.js', 'xr.js',
  '../shared/icon.svg', '../shared/plan.js', '../shared/rest.js', '../shared/socket.js',
  '../shared/theme.css', '../shared/view.js',
];

self.addEventListener('install', (event) => {
  event.waitUntil(caches.open(STORE).then((store) => store.addAll(FILES)));
  self.skipWaiting();
});

self.addEventListener('activate', (event) => {
  event.waitUntil(leaveOthers().then(() => self.clients.claim()));
});

self.addEventListener('fetch', (event) => {
  const { method, url } = event.request;
  const { origin, pathname } = new URL(url);
  const isPage = origin === location.origin && /^\/(phone|shared)(\/|$)/.test(pathname);
  if (method === 'GET' && isPage) event.respondWith(newest(event.request));
});

async function leaveOthers() {
  const names = await caches.keys();
  const old = names.filter((name) => name.startsWith('palms-phone-') && name !== STORE);
  await Promise.all(old.map((name) => caches.delete(name)));
}

/** @param {Request} request */
async function newest(request) {
  const store = await caches.open(STORE);
  try {
    const answer = await fetch(request, { signal: AbortSignal.timeout(PATIENCE_MS) });
    if (answer.ok && !answer.redirected) await store.put(request, answer.clone());
    return answer;
  } catch (problem) {
    const kept = await store.match(request, { ignoreSearch: true });
    if (kept) return kept;
    throw problem;
  }
}
