import { ask } from "./served.js";

const SQLITE = "vendor/sqlite/sqlite3";

/** Whether a file is a library, by its name. */
export function isLibrary({ name }) {
  return name.toLowerCase().endsWith(".mocapdb");
}

/** A library that was dropped on the page: a worker reads it. */
export class DroppedLibrary {
  /**
   * @param {{name: string, bytes: Uint8Array}} file which is handed over
   * @param {import("../work/reader.js").Reader} reader
   */
  constructor(file, reader) {
    this.name = file.name;
    this.file = file;
    this.reader = reader;
  }

  /** @returns {Promise<{clips: import("../panels/library.js").StoredClip[], errors: string[]}>} */
  async catalogue() {
    const failed = (errors) => ({ clips: [], errors: errors.map((e) => `${this.name}: ${e}`) });
    // Only a served page can get SQLite; it is too large to be in each.
    if (!document.querySelector("meta[name=served]")) {
      return failed(["a library; expected a page of `mocapress view`, which can read it"]);
    }
    const parts = await Promise.all([ask(`${SQLITE}.mjs`), ask(`${SQLITE}.wasm`)]);
    const [missing] = parts.filter(({ response }) => !response);
    if (missing) return failed(missing.errors);
    const [code, wasm] = parts.map(({ response }) => response);
    return this.reader.library(this.file, await code.text(), new Uint8Array(await wasm.arrayBuffer()));
  }

  /** As of `ServedLibrary`. */
  read({ id, name }, begun) {
    return this.reader.stored(id, name, begun);
  }

  /** As of `ServedLibrary`; stretches are ranked by alignment alone. */
  similar({ id, name }, stretch) {
    return this.reader.similar(id, name, stretch);
  }
}
