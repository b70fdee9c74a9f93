import { decodeStream, openMcz } from "../../mcz/mcz.js";
import { FileError } from "./file_error.js";
import { skeletonOfBones } from "./motion_file.js";

const MOST_VALUES = 5e7; // 400 MB
const LONG = 4096; // frames

/**
 * Read a .mcz file: its first stream is played.
 *
 * @param {Uint8Array} bytes
 * @param {Uint8Array[]} models `.mcm` files among which that is which the file may name
 * @param {{name: string, bytes: Uint8Array}|null} beside the ASF of an AMC, for where the file has no
 *     skeleton
 * @param {import("../../mcz/assets.js").Assets} assets
 * @param {boolean} [early] whether only the first frames are decoded, where there are many
 * @returns {Promise<import("./clip.js").Clip>}
 * @throws {FileError|import("../../mcz/error.js").MczError}
 */
export async function readMcz(bytes, models, beside, assets, early = false) {
  const mcz = await openMcz(bytes, assets);
  const main = mcz.streams.findIndex(({ kind }) => kind === "channels");
  if (main < 0) throw new FileError("no stream that this page knows");
  const { columns, frameTime, name } = mcz.streams[main];
  const total = mcz.chunks[main].reduce((sum, chunk) => sum + chunk.frames, 0);
  const more = early && total > LONG;
  const frames = more ? mcz.chunks[main][0].frames : total;
  if (frames * columns.length > MOST_VALUES) {
    throw new FileError("too many frames and channels", {
      expected: `a product of at most ${MOST_VALUES}`,
      found: `${frames} x ${columns.length}`,
    });
  }
  const channels = columns.map(() => new Float64Array(frames));
  for await (const chunk of decodeStream(mcz, main, models, assets)) {
    channels.forEach((channel, column) => {
      const end = chunk.first + chunk.frames;
      for (let frame = chunk.first, at = column; frame < end; frame++, at += columns.length) {
        channel[frame] = chunk.values[at];
      }
    });
    if (more) break;
  }
  const unit = columns.find(({ kind }) => kind[0] === "r")?.unit;
  const others = mcz.streams.filter((_, i) => i !== main).map((stream) => stream.name);
  const radians = unit === "rad";
  const { names, skeleton } = mcz.skeleton
    ? ownSkeleton(mcz.skeleton, columns)
    : await skeletonBeside(columns, beside, radians, assets);
  const notes = [
    skeleton ? "" : "no skeleton in this file: only its curves can be shown; drop the .asf with it",
    mcz.closed ? "" : "the recording was not closed",
    others.length ? `only stream ${name} is shown, not ${others.join(", ")}` : "",
  ];
  const angleUnit = radians || unit === "deg" ? unit : undefined;
  const own = { names, frames, channels, skeleton, frameTime, angleUnit };
  return { ...own, notes: notes.filter(Boolean), more };
}

function ownSkeleton(skeleton, columns) {
  const places = columns.map(({ joint, kind }) => [joint, kind]);
  return { names: columns.map(({ name }) => name), skeleton: { ...skeleton, columns: places } };
}

async function skeletonBeside(columns, asf, radians, assets) {
  const named = { names: columns.map(({ name }) => name), skeleton: null };
  if (!asf || !columns.every(({ bone }) => bone !== undefined)) return named;
  const bones = [];
  let last;
  for (const { bone: name, joint } of columns) {
    if (bones.length && joint === last) bones.at(-1).count++;
    else bones.push({ name, count: 1 });
    last = joint;
  }
  return skeletonOfBones(asf, bones, radians, assets);
}
