import { MczError } from "./error.js";

/**
 * Make an instance of one of the core's modules. Where it gives up, it throws MczError, and must not
 * be used again.
 *
 * @param {WebAssembly.Module} module of viewer/wasm
 * @returns {WebAssembly.Instance}
 */
export function instantiate(module) {
  const instance = new WebAssembly.Instance(module, {
    page: {
      fail(text, size) {
        const bytes = new Uint8Array(instance.exports.memory.buffer, text, size);
        throw new MczError(new TextDecoder().decode(bytes));
      },
    },
  });
  instance.exports._initialize();
  return instance;
}
