import { decodeStream, openMcz } from "../../mcz/mcz.js";
import { columnsOf } from "./amc.js";
import { FileError } from "./file_error.js";
import { channelNames } from "./skeleton.js";

const MOST_VALUES = 5e7; // 400 MB

/**
 * Read a .mcz file: its first stream is played.
 *
 * @param {Uint8Array} bytes
 * @param {Uint8Array[]} models `.mcm` files among which that is which the file may name
 * @param {import("./skeleton.js").Skeleton|null} beside of an AMC that does not have its own
 * @param {import("../../mcz/assets.js").Assets} assets
 * @returns {Promise<import("./clip.js").Clip>}
 * @throws {FileError|import("../../mcz/error.js").MczError}
 */
export async function readMcz(bytes, models, beside, assets) {
  const mcz = await openMcz(bytes, assets);
  const main = mcz.streams.findIndex(({ kind }) => kind === "channels");
  if (main < 0) throw new FileError("no stream that this page knows");
  const { columns, frameTime, name } = mcz.streams[main];
  const frames = mcz.chunks[main].reduce((sum, chunk) => sum + chunk.frames, 0);
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
  }
  const unit = columns.find(({ kind }) => kind[0] === "r")?.unit;
  const others = mcz.streams.filter((_, i) => i !== main).map((stream) => stream.name);
  const skeleton = skeletonOf(mcz.skeleton, columns, beside);
  const notes = [
    skeleton ? "" : "no skeleton in this file: only its curves can be shown; drop the .asf with it",
    mcz.closed ? "" : "the recording was not closed",
    others.length ? `only stream ${name} is shown, not ${others.join(", ")}` : "",
  ];
  return {
    names: skeleton && !mcz.skeleton ? channelNames(skeleton) : columns.map((column) => column.name),
    frames,
    channels,
    skeleton,
    frameTime,
    angleUnit: unit === "deg" || unit === "rad" ? unit : undefined,
    notes: notes.filter(Boolean),
  };
}

function skeletonOf(own, columns, beside) {
  if (own) return { ...own, columns: columns.map(({ joint, kind }) => [joint, kind]) };
  if (!beside || !columns.every(({ bone }) => bone !== undefined)) return null;
  const bones = [];
  for (const { bone: name, joint } of columns) {
    if (bones.at(-1)?.joint === joint) bones.at(-1).count++;
    else bones.push({ name, joint, count: 1 });
  }
  return { ...beside, columns: columnsOf(beside, bones) };
}
