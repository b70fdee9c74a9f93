// Prints what the page makes of files: positions of some frames, or the error. For tests/viewer.
import { readFileSync } from "node:fs";
import { basename } from "node:path";

import { Kinematics } from "../../viewer/page/state/kinematics.js";
import { readFiles } from "../../viewer/page/reading/files.js";
import { assets } from "./assets.mjs";

const paths = process.argv.slice(2);
const { clips, errors } = await readFiles(
  paths.map((path) => ({ name: basename(path), bytes: readFileSync(path) })),
  assets,
);
const made = clips.map((clip) => {
  const frames = [0, 1, clip.frames >> 1, clip.frames - 1];
  const kinematics = clip.skeleton && new Kinematics(clip);
  const positions = frames.map((frame) => {
    const points = new Float64Array(kinematics ? 3 * kinematics.points : 0);
    kinematics?.place(frame, points);
    return [...points];
  });
  return {
    names: clip.names,
    values: clip.channels.map((channel) => frames.map((frame) => channel[frame])),
    length: clip.frames,
    frameTime: clip.frameTime,
    frames,
    positions,
    notes: clip.notes,
  };
});
process.stdout.write(JSON.stringify({ clips: made, errors }));
