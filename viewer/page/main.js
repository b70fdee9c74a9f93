import { App } from "./app.js";
import { Notices } from "./panels/notice.js";
import { ServedLibrary } from "./reading/served.js";
import { Reader } from "./work/reader.js";

/** Begin with what the page carries; `worker` is to run work/worker.js. */
export function start(worker) {
  let app;
  const reader = new Reader(worker);
  try {
    app = new App(reader);
  } catch (error) {
    // three.js gives no kind of error of its own to tell by.
    document.body.classList.add("empty");
    new Notices(document.getElementById("notices")).show([
      `This page draws with WebGL, which this browser does not offer (${error.message}).`,
    ]);
  }
  const library = document.querySelector("meta[name=library]")?.content;
  if (library) app?.openLibrary(new ServedLibrary(library, reader));
  else app?.openEmbedded(document.getElementById("clips").textContent);
}
