// Prints the SHA-256 of the doubles of all streams, row by row, of each .mcz named on standard input,
// a line each, or what is wrong with it; .mcm files are the models that they may name.
import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";

import { MczError } from "../../viewer/mcz/error.js";
import { decodeStream, openMcz } from "../../viewer/mcz/mcz.js";
import { assets } from "./assets.mjs";

async function digest(file, models) {
  const hash = createHash("sha256");
  const mcz = await openMcz(file, assets);
  for (let stream = 0; stream < mcz.streams.length; stream++) {
    for await (const { values } of decodeStream(mcz, stream, models, assets)) {
      hash.update(new Uint8Array(values.buffer));
    }
  }
  return hash.digest("hex");
}

const files = readFileSync(0, "utf8").split("\n").filter(Boolean);
const models = files.filter((name) => name.endsWith(".mcm")).map((name) => readFileSync(name));
for (const name of files.filter((file) => !file.endsWith(".mcm"))) {
  try {
    console.log(await digest(readFileSync(name), models));
  } catch (error) {
    if (!(error instanceof MczError)) throw error;
    console.log(`error: ${error.message}`);
  }
}
