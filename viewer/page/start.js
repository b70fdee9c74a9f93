// Unpacks the modules that the page carries and gives each a URL by which the next can import it.
const packed = atob(document.getElementById("modules").textContent);
const bytes = Uint8Array.from(packed, (character) => character.charCodeAt(0));
const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
const urls = new Map();
for (const [path, source] of await new Response(stream).json()) {
  const text = source.replace(/"module:([^"]+)"/g, (_, name) => `"${urls.get(name)}"`);
  urls.set(path, URL.createObjectURL(new Blob([text], { type: "text/javascript" })));
}
await import(urls.get("page/main.js"));
