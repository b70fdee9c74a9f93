// Prints the SHA-256 of all channels' doubles, little-endian, of each document named.
//   node diffma_digest.mjs FILE...

import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";

import { decode } from "../../viewer/diffma/diffma.js";

for (const file of process.argv.slice(2)) {
  const hash = createHash("sha256");
  for (const channel of decode(readFileSync(file, "utf8")).channels) {
    hash.update(new Uint8Array(channel.buffer));
  }
  console.log(hash.digest("hex"));
}
