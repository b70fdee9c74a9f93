// The core as WebAssembly: what the modules are, and what they do with what is no file.
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { test } from "node:test";
import { brotliCompressSync } from "node:zlib";

import { crc32 } from "../../viewer/mcz/crc32.js";
import { MczError } from "../../viewer/mcz/error.js";
import { decodeStream, openMcz } from "../../viewer/mcz/mcz.js";
import { assets } from "./assets.mjs";

const WASM = new URL("../../viewer/wasm/", import.meta.url);
const GOLDEN = new URL("../golden/", import.meta.url);

/** The digests of all chunks of a file, or its error. */
async function decoded(bytes) {
  const digests = [];
  try {
    const mcz = await openMcz(bytes, assets);
    for (let stream = 0; stream < mcz.streams.length; stream++) {
      for await (const { values } of decodeStream(mcz, stream, [], assets)) {
        digests.push(crc32(new Uint8Array(values.buffer)));
      }
    }
  } catch (error) {
    if (!(error instanceof MczError)) throw error;
    return error;
  }
  return digests;
}

for (const name of readdirSync(WASM).filter((file) => file.endsWith(".wasm"))) {
  test(`${name} is small, and asks for nothing of the page but to be told of faults`, () => {
    const bytes = readFileSync(new URL(name, WASM));
    const most = name === "near.wasm" ? 200 : 100; // near's has what its models know before
    assert.ok(brotliCompressSync(bytes).length <= most * 1024);
    const imports = WebAssembly.Module.imports(new WebAssembly.Module(bytes));
    assert.deepEqual(imports, [{ module: "page", name: "fail", kind: "function" }]);
  });
}

test("a CRC-32 is that of PNG", () => {
  assert.equal(crc32(new TextEncoder().encode("123456789")), 0xcbf43926);
  assert.equal(crc32(new Uint8Array(0)), 0);
});

for (const name of ["v1_still.mcz", "v1_recorded.mcz", "v1_lossy.amc.mcz", "v1_numbers_app.mcz"]) {
  test(`every flipped bit and every cut of ${name} is seen`, async () => {
    const whole = readFileSync(new URL(name, GOLDEN));
    const expected = await decoded(whole);
    assert.ok(expected.length > 0);
    const step = Math.max(1, Math.floor(whole.length / 400));
    for (let at = 0; at < whole.length; at += step) {
      const flipped = Uint8Array.from(whole);
      flipped[at] ^= 1 << at % 8;
      const found = await decoded(flipped);
      // Only the end of a recording may be missing.
      const fits = Array.isArray(found) && name.includes("recorded");
      assert.ok(found instanceof MczError || fits, `bit of byte ${at}`);
      if (fits) assert.deepEqual(found, expected.slice(0, found.length));
      const cut = await decoded(whole.subarray(0, at));
      assert.ok(cut instanceof MczError || name.includes("recorded"), `cut at ${at}`);
    }
  });
}
