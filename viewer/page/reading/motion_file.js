import { instantiate } from "../../mcz/instance.js";
import { FileError } from "./file_error.js";

/**
 * Read a BVH file.
 *
 * @param {Uint8Array} bytes
 * @param {import("../../mcz/assets.js").Assets} assets
 * @returns {Promise<import("./clip.js").Clip>}
 * @throws {FileError} where it does not follow the format, or frames are missing
 */
export async function readBvh(bytes, assets) {
  const core = await formats(assets);
  return clipOf(core, core.read(true, bytes, null));
}

/**
 * Read an AMC file. A bone that a frame leaves out keeps its values of the frame before.
 *
 * @param {Uint8Array} bytes
 * @param {{name: string, bytes: Uint8Array}|null} asf its skeleton; null gives curves without figure
 * @param {import("../../mcz/assets.js").Assets} assets
 * @returns {Promise<import("./clip.js").Clip>}
 * @throws {FileError} where it does not follow the format, or the skeleton
 */
export async function readAmc(bytes, asf, assets) {
  const core = await formats(assets);
  const clip = clipOf(core, core.read(false, bytes, asf && asf.bytes), asf?.name);
  if (!asf) clip.notes.unshift("no skeleton: drop the .asf together with the .amc");
  return clip;
}

/**
 * Find the joints of an ASF that bones move.
 *
 * @param {{name: string, bytes: Uint8Array}} asf
 * @param {{name: string, count: number}[]} bones in the order of the columns
 * @param {boolean} radians whether the columns' angles are
 * @param {import("../../mcz/assets.js").Assets} assets
 * @returns {Promise<{names: string[], skeleton: import("./skeleton.js").Skeleton}>}
 */
export async function skeletonOfBones(asf, bones, radians, assets) {
  const core = await formats(assets);
  const said = core.bones(asf.bytes, recordOf(bones), radians);
  refuse(said, asf.name);
  return { names: said.columns.map(({ name }) => name), skeleton: skeletonOf(core, said) };
}

/** The core's readers, which are used for one file. */
export async function formats(assets) {
  const { exports } = instantiate(await assets.module("wasm/formats.wasm"));
  const at = (place, count) => new Float64Array(exports.memory.buffer, place, count);
  const write = (...parts) => {
    let place = exports.space(parts.reduce((sum, part) => sum + part.length, 0));
    for (const part of parts) {
      new Uint8Array(exports.memory.buffer).set(part, place);
      place += part.length;
    }
  };
  const told = (place) => {
    const text = new Uint8Array(exports.memory.buffer, place, exports.said());
    return JSON.parse(new TextDecoder().decode(text));
  };
  return {
    read(isBvh, bytes, asf) {
      write(bytes, asf ?? new Uint8Array(0));
      return told(exports.read(isBvh, bytes.length, asf !== null, asf?.length ?? 0));
    },
    c3d(bytes) {
      write(bytes);
      return told(exports.c3d(bytes.length));
    },
    bones(asf, bones, radians) {
      write(asf, bones);
      return told(exports.bones(asf.length, bones.length, radians));
    },
    numbers: () => at(exports.numbers(), exports.count()),
    values: (count) => at(exports.values(), count),
  };
}

function clipOf(core, said, asf) {
  refuse(said, asf);
  const { columns, frames } = said;
  const values = core.values(frames * columns.length);
  const channels = columns.map((_, column) => {
    const channel = new Float64Array(frames);
    for (let row = 0, at = column; row < frames; row++, at += columns.length) channel[row] = values[at];
    return channel;
  });
  const seconds = core.numbers().at(-1);
  const unit = columns.find(({ kind }) => kind[0] === "r")?.unit;
  return {
    names: columns.map(({ name }) => name),
    frames,
    channels,
    skeleton: said.skeleton ? skeletonOf(core, said) : null,
    frameTime: seconds > 0 ? seconds : null,
    angleUnit: unit || undefined,
    notes: said.problems.map((problem) => new FileError(problem.what, problem).message),
  };
}

/** Throw what is wrong: the file's fault, or that motion is lost. */
function refuse({ fault, ofSkeleton, problems = [] }, asf) {
  const found = fault ?? problems.find(({ losesMotion }) => losesMotion);
  if (found) throw new FileError(found.what, { ...found, file: ofSkeleton ? asf : undefined });
}

/** The skeleton, whose numbers stand apart: length unit, then offset, axis and ends of each joint. */
function skeletonOf(core, { skeleton, columns }) {
  const numbers = core.numbers();
  const lengthUnit = Number.isNaN(numbers[0]) ? null : numbers[0];
  let at = 1;
  const vector = () => [numbers[at++], numbers[at++], numbers[at++]];
  const joints = skeleton.joints.map((joint) => {
    const [offset, axis] = [vector(), vector()];
    return { ...joint, offset, axis, ends: Array.from({ length: joint.ends }, vector) };
  });
  return { ...skeleton, lengthUnit, joints, columns: columns.map(({ joint, kind }) => [joint, kind]) };
}

/** Bones as the core takes them: `bytes` name and `int` count of each. */
function recordOf(bones) {
  const bytes = [];
  const integer = (value) => {
    for (; value > 127; value = Math.floor(value / 128)) bytes.push((value % 128) | 128);
    bytes.push(value);
  };
  for (const { name, count } of bones) {
    const text = new TextEncoder().encode(name);
    integer(text.length);
    for (const byte of text) bytes.push(byte);
    integer(count);
  }
  return Uint8Array.from(bytes);
}
