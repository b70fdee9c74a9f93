// Prints what the package says of a file, for test_npm.py to compare with Python: facts, then for each
// time a pose in space and one relative to the parents.
import { readFile } from "node:fs/promises";

import { MczError, open } from "mocapress";

const [file, rate, ...times] = process.argv.slice(2);
try {
  const clip = await open(await readFile(file));
  if (rate > 0) clip.frameTime = 1 / rate;
  const poses = times.map(Number).map((time) =>
    ["world", "local"].map((space) => {
      const { positions, rotations } = clip.pose(time, { space, into: clip.makePose() });
      return [[...positions], [...rotations]];
    }),
  );
  const { frames, frameTime, joints, parents, channels, unit } = clip;
  const values = [0, frames - 1].map((frame) => [...clip.values(frame)]);
  console.log(JSON.stringify({ frames, frameTime, joints, parents, channels, unit, values, poses }));
} catch (error) {
  if (!(error instanceof MczError || error instanceof RangeError)) throw error;
  console.log(JSON.stringify({ error: `${error.constructor.name}: ${error.message}` }));
}
