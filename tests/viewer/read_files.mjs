// Prints what the page makes of files, a line of JSON for each line of names on standard input, which
// are those of files that are dropped together, separated by tabs.
import { readFileSync } from "node:fs";
import { basename } from "node:path";

import { readFiles } from "../../viewer/page/reading/files.js";
import { placesOf } from "../../viewer/page/work/placing.js";
import { assets } from "./assets.mjs";
import { digests } from "./reading_digests.mjs";

for (const line of readFileSync(0, "utf8").split("\n").filter(Boolean)) {
  const files = line.split("\t").map((path) => ({ name: basename(path), bytes: readFileSync(path) }));
  console.log(JSON.stringify(await digests({ readFiles, placesOf }, files, assets)));
}
