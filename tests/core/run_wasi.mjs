// Runs a program built for WASI: node --no-warnings run_wasi.mjs PROGRAM
import { readFileSync } from "node:fs";
import { WASI } from "node:wasi";

const wasi = new WASI({ version: "preview1", args: [], env: {} });
const instance = new WebAssembly.Instance(new WebAssembly.Module(readFileSync(process.argv[2])), {
  wasi_snapshot_preview1: wasi.wasiImport,
  page: {
    fail(text, size) {
      throw new Error(Buffer.from(instance.exports.memory.buffer, text, size).toString());
    },
  },
});
process.exitCode = wasi.start(instance);
