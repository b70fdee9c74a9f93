/**
 * @typedef {Object} Read
 * @property {import("../reading/clip.js").Clip[]} clips
 * @property {string[]} errors what is wrong with the others
 */

/** Has files read by a worker, so that the page goes on meanwhile. */
export class Reader {
  #waiting = new Map();
  #count = 0;

  /** @param {Worker} worker that runs work/worker.js */
  constructor(worker) {
    this.worker = worker;
    worker.addEventListener("message", ({ data: { id, early, read } }) => {
      const { done, begun } = this.#waiting.get(id);
      if (early) begun(read);
      else {
        done(read);
        this.#waiting.delete(id);
      }
    });
    worker.addEventListener("error", ({ message }) => {
      const read = { clips: [], hits: [], errors: [`This page cannot read files in this browser (${message}).`] };
      for (const { done } of this.#waiting.values()) done(read);
      this.#waiting.clear();
    });
  }

  /**
   * @param {{name: string, bytes: Uint8Array}[]} files which are handed over
   * @param {function(Read): void} begun is given the beginnings of clips, where some are long
   * @returns {Promise<Read>}
   */
  files(files, begun) {
    const buffers = files.map(({ bytes }) => bytes.buffer);
    return this.#ask({ files }, begun, buffers);
  }

  /**
   * Open a library; `stored` then reads its clips.
   *
   * @param {{name: string, bytes: Uint8Array}} file which is handed over
   * @param {string} code SQLite's module
   * @param {Uint8Array} wasm
   * @returns {Promise<{clips: import("../panels/library.js").StoredClip[], errors: string[]}>}
   */
  library(file, code, wasm) {
    return this.#ask({ library: { file, code, wasm } }, () => {}, [file.bytes.buffer, wasm.buffer]);
  }

  /**
   * @param {number} stored id of a clip of the library
   * @param {string} name for messages
   * @param {function(Read): void} begun as of `files`
   * @returns {Promise<Read>}
   */
  stored(stored, name, begun) {
    return this.#ask({ stored, name }, begun, []);
  }

  /**
   * @param {number} similar id of a clip of the library
   * @param {string} name for messages
   * @param {[number, number]|null} stretch of the clip
   * @returns {Promise<{hits: import("../panels/library.js").Hit[], errors: string[]}>}
   */
  similar(similar, name, stretch) {
    return this.#ask({ similar, name, stretch }, () => {}, []);
  }

  /**
   * @param {string} text JSON: the clips that the page carries
   * @param {function(Read): void} begun as of `files`
   * @returns {Promise<Read>}
   */
  embedded(text, begun) {
    return this.#ask({ text }, begun, []);
  }

  #ask(question, begun, transfer) {
    return new Promise((done) => {
      const id = this.#count++;
      this.#waiting.set(id, { done, begun });
      this.worker.postMessage({ id, ...question }, transfer);
    });
  }
}
