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
    worker.addEventListener("message", ({ data: { id, read } }) => {
      this.#waiting.get(id)(read);
      this.#waiting.delete(id);
    });
    worker.addEventListener("error", ({ message }) => {
      const read = { clips: [], errors: [`This page cannot read files in this browser (${message}).`] };
      for (const done of this.#waiting.values()) done(read);
      this.#waiting.clear();
    });
  }

  /**
   * @param {{name: string, bytes: Uint8Array}[]} files which are handed over
   * @returns {Promise<Read>}
   */
  files(files) {
    return this.#ask({ files }, files.map(({ bytes }) => bytes.buffer));
  }

  /**
   * @param {string} text JSON: the clips that the page carries
   * @returns {Promise<Read>}
   */
  embedded(text) {
    return this.#ask({ text });
  }

  #ask(question, transfer = []) {
    return new Promise((done) => {
      const id = this.#count++;
      this.#waiting.set(id, done);
      this.worker.postMessage({ id, ...question }, transfer);
    });
  }
}
