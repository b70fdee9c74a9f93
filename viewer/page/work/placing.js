import { instantiate } from "../../mcz/instance.js";
import { rigOf } from "../../mcz/rig.js";
import { FileError } from "../reading/file_error.js";

// Places of points that fit a browser's memory: three hours of a person at 120 frames a second.
const MOST_PLACES = 5e7;
const TOGETHER = 512; // frames

/**
 * @typedef {import("../reading/clip.js").Clip & {
 *   parents: number[], positions: Float32Array, gaps?: Uint8Array}} PlacedClip
 * parents: of each point, joints before end sites, its parent's index, -1 for a root or a marker;
 * positions: (F, P, 3) in the file's units; both empty without a skeleton or markers; a marker that is
 * missing keeps its place, the first one before it is seen;
 * gaps: of markers (F, P), 1 where one is missing for a while, 2 before it is seen first and after last
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
  if (clip.markers) return placedMarkers(clip);
  if (!clip.skeleton) return { ...clip, parents: [], positions: new Float32Array(0) };
  const { joints } = clip.skeleton;
  const ends = joints.flatMap((joint, index) => joint.ends.map(() => index));
  const parents = [...joints.map(({ parent }) => parent), ...ends];
  refuseTooMany(clip, parents.length);
  const positions = new Float32Array(clip.frames * parents.length * 3);
  for await (const { first, places } of placesOf(clip, assets)) {
    positions.set(places, first * parents.length * 3);
  }
  return { ...clip, parents, positions };
}

function placedMarkers(clip) {
  const { frames, channels } = clip;
  const points = clip.markers.drawn;
  refuseTooMany(clip, points);
  const positions = new Float32Array(3 * frames * points);
  const gaps = new Uint8Array(frames * points);
  for (let point = 0; point < points; point++) {
    const place = channels.slice(3 * point, 3 * point + 3);
    const isThere = (x) => !Number.isNaN(x);
    const [first, end] = [place[0].findIndex(isThere), place[0].findLastIndex(isThere)];
    let last = Math.max(0, first);
    for (let frame = 0; frame < frames; frame++) {
      const missing = place.some((values) => Number.isNaN(values[frame]));
      if (!missing) last = frame;
      const outside = frame < first || frame > end;
      gaps[frame * points + point] = missing ? 1 + outside : 0;
      for (let axis = 0; axis < 3; axis++) {
        positions[3 * (frame * points + point) + axis] = place[axis][last];
      }
    }
  }
  return { ...clip, parents: Array(points).fill(-1), positions, gaps };
}

function refuseTooMany({ name, frames }, points) {
  if (frames * points <= MOST_PLACES) return;
  throw new FileError("too many frames and points to be shown", {
    file: name,
    expected: `a product of at most ${MOST_PLACES}`,
    found: `${frames} x ${points}`,
  });
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
