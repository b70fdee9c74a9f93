import { instantiate } from "../../mcz/instance.js";
import { FileError } from "../reading/file_error.js";

// Places of points that fit a browser's memory: three hours of a person at 120 frames a second.
const MOST_PLACES = 5e7;
const TOGETHER = 512; // frames
const KINDS = ["tx", "ty", "tz", "rx", "ry", "rz", "l", "sx", "sy", "sz"];

/**
 * @typedef {import("../reading/clip.js").Clip & {
 *   parents: number[], positions: Float32Array}} PlacedClip
 * parents: of each point, joints before end sites, its parent's index, -1 for a root;
 * positions: (F, P, 3) in the file's units; both empty without a skeleton
 */

/**
 * Place the points of all frames.
 *
 * @param {import("../reading/clip.js").Clip} clip
 * @param {import("../../mcz/assets.js").Assets} assets
 * @returns {Promise<PlacedClip>}
 * @throws {FileError} when its skeleton cannot be placed, or has too many points
 */
export async function placed(clip, assets) {
  if (!clip.skeleton) return { ...clip, parents: [], positions: new Float32Array(0) };
  const { joints } = clip.skeleton;
  const ends = joints.flatMap((joint, index) => joint.ends.map(() => index));
  const parents = [...joints.map(({ parent }) => parent), ...ends];
  if (clip.frames * parents.length > MOST_PLACES) {
    throw new FileError("too many frames and joints to be shown", {
      file: clip.name,
      expected: `a product of at most ${MOST_PLACES}`,
      found: `${clip.frames} x ${parents.length}`,
    });
  }
  const positions = new Float32Array(clip.frames * parents.length * 3);
  for await (const { first, places } of placesOf(clip, assets)) {
    positions.set(places, first * parents.length * 3);
  }
  return { ...clip, parents, positions };
}

/**
 * Place the points of a clip with a skeleton, some frames at a time.
 *
 * @yields {{first: number, places: Float64Array}} (frames, P, 3), good until the next
 */
export async function* placesOf({ skeleton, channels, frames, angleUnit }, assets) {
  const { exports } = instantiate(await assets.module("wasm/kinematics.wasm"));
  const rig = rigOf(skeleton, angleUnit ?? skeleton.angleUnit);
  const write = (count) => {
    const place = exports.space(8 * count); // after which the memory may be another
    return new Float64Array(exports.memory.buffer, place, count);
  };
  write(rig.length).set(rig);
  const points = exports.rig(rig.length);
  const columns = channels.length;
  for (let first = 0; first < frames; first += TOGETHER) {
    const count = Math.min(TOGETHER, frames - first);
    const rows = write(count * columns);
    channels.forEach((channel, column) => {
      for (let k = 0, at = column; k < count; k++, at += columns) rows[at] = channel[first + k];
    });
    const place = exports.place(count, columns);
    if (!place) throw new FileError("bones that stretch (channel l) have no kinematics here");
    yield { first, places: new Float64Array(exports.memory.buffer, place, count * points * 3) };
  }
}

/** A skeleton and its columns as the numbers that the core takes: core/wasm/kinematics.cpp. */
function rigOf({ rotation, angleUnit, joints, columns }, unit) {
  const numbers = [rotation === "fixed", angleUnit === "rad", unit === "rad", joints.length];
  for (const { parent, offset, axis, axisOrder, channels, ends } of joints) {
    numbers.push(parent + 1, ...offset, ...axis, ...[...axisOrder].map((x) => "xyz".indexOf(x)));
    numbers.push(channels.length, ...channels.map((kind) => KINDS.indexOf(kind)));
    numbers.push(ends.length);
    for (const end of ends) numbers.push(...end);
  }
  numbers.push(columns.length);
  for (const [joint, kind] of columns) {
    const known = KINDS.indexOf(kind);
    numbers.push(known < 0 ? 0 : joint + 1, Math.max(known, 0));
  }
  return Float64Array.from(numbers, Number);
}
