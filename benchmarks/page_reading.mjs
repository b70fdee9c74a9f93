// Prints how much processor time the page's reading of files takes, in Node: to decode or parse, and
// to place the joints. The first file also pays for starting up.
//   node benchmarks/page_reading.mjs FILE...
import { readFileSync } from "node:fs";
import { basename } from "node:path";

import { assets } from "../tests/viewer/assets.mjs";
import { readFiles } from "../viewer/page/reading/files.js";
import { placed } from "../viewer/page/work/placing.js";

const seconds = (since) => {
  const { user, system } = process.cpuUsage(since);
  return ((user + system) / 1e6).toFixed(2);
};

for (const path of process.argv.slice(2)) {
  const file = { name: basename(path), bytes: readFileSync(path) };
  let begun = process.cpuUsage();
  const { clips, errors } = await readFiles([file], assets);
  const read = seconds(begun);
  begun = process.cpuUsage();
  for (const clip of clips) await placed(clip, assets);
  const frames = clips.map((clip) => clip.frames).join(", ");
  console.log(`${file.name}: ${frames || errors} frames, read ${read} s, placed ${seconds(begun)} s`);
}
