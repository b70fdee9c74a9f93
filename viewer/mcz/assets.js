/** The binary files of viewer/ that reading needs; compiled modules are kept. */
export class Assets {
  #modules = new Map();

  /** @param {function(string): Uint8Array|Promise<Uint8Array>} read gives a file by its path */
  constructor(read) {
    this.bytes = read;
  }

  /** @returns {Promise<WebAssembly.Module>} */
  module(path) {
    if (!this.#modules.has(path)) {
      this.#modules.set(path, Promise.resolve(this.bytes(path)).then(WebAssembly.compile));
    }
    return this.#modules.get(path);
  }
}
