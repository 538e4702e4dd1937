// Keeps the page, so that it opens without a network after the first visit. The name of what is kept is its digest.
const { digest, files } = JSON.parse("@@KEPT@@");
const NAME = `truebreak-play-${digest}`;

addEventListener("install", (event) => {
  event.waitUntil(caches.open(NAME).then((kept) => kept.addAll(files)).then(() => skipWaiting()));
});

addEventListener("activate", (event) => {
  const old = (name) => name.startsWith("truebreak-play-") && name !== NAME;
  event.waitUntil(caches.keys().then((names) => Promise.all(names.filter(old).map((name) => caches.delete(name)))).then(() => clients.claim()));
});

addEventListener("fetch", (event) => {
  if (event.request.method !== "GET") return;
  event.respondWith(caches.open(NAME).then(async (kept) => (await kept.match(event.request, { ignoreSearch: true })) ?? fetch(event.request)));
});
