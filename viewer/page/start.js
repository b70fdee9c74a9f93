// Unpacks the modules that the page carries and gives each a URL by which the next can import it; in
// the page, and again in a worker, for a worker of a page on disk may not import the page's URLs.
function load(modules, main) {
  const urls = new Map();
  for (const [path, source] of modules) {
    const text = source.replace(/"module:([^"]+)"/g, (_, name) => `"${urls.get(name)}"`);
    urls.set(path, URL.createObjectURL(new Blob([text], { type: "text/javascript" })));
  }
  return import(urls.get(main));
}

async function unpacked(id) {
  const packed = atob(document.getElementById(id).textContent);
  const bytes = Uint8Array.from(packed, (character) => character.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

const json = (bytes) => JSON.parse(new TextDecoder().decode(bytes));

// Names and sizes in a line, then the files.
function filesOf(bytes) {
  let at = bytes.indexOf(10);
  const sizes = json(bytes.subarray(0, at++));
  return Object.fromEntries(sizes.map(([name, size]) => [name, bytes.slice(at, (at += size))]));
}

const inWorker = `
${load}
let started;
onmessage = async ({ data }) => {
  if (started) (await started).answer(data);
  else {
    started = load(data.modules, "page/work/worker.js");
    (await started).begin(data.assets);
  }
};`;

const [code, carried] = await Promise.all(["modules", "assets"].map(unpacked));
const [modules, assets] = [json(code), filesOf(carried)];
const worker = new Worker(URL.createObjectURL(new Blob([inWorker], { type: "text/javascript" })));
worker.postMessage({ modules, assets });
const { start } = await load(modules, "page/main.js");
start(worker);
