import { decodeStream, layoutOf, openMcz } from "../../mcz/mcz.js";
import { describedC3d } from "./c3d.js";
import { FileError } from "./file_error.js";
import { markerClip } from "./markers.js";
import { skeletonOfBones } from "./motion_file.js";
import { describedTrc } from "./trc.js";

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
  const stream = mcz.streams[main];
  const markers = stream.name === "points" && stream.columns.length > 0;
  const total = mcz.chunks[main].reduce((sum, chunk) => sum + chunk.frames, 0);
  const more = early && total > LONG && !markers;
  const frames = more ? mcz.chunks[main][0].frames : total;
  const channels = await decoded(mcz, main, models, assets, frames);
  const closed = mcz.closed ? [] : ["the recording was not closed"];
  if (markers) {
    const clip = await markersOf(mcz, stream, channels, frames, models, assets);
    return { ...clip, notes: [...closed, ...clip.notes] };
  }
  const { columns, frameTime, name } = stream;
  const unit = columns.find(({ kind }) => kind[0] === "r")?.unit;
  const others = mcz.streams.filter((_, i) => i !== main).map((other) => other.name);
  const radians = unit === "rad";
  const { names, skeleton } = mcz.skeleton
    ? ownSkeleton(mcz.skeleton, columns)
    : await skeletonBeside(columns, beside, radians, assets);
  const notes = [
    skeleton ? "" : "no skeleton in this file: only its curves can be shown; drop the .asf with it",
    ...closed,
    others.length ? `only stream ${name} is shown, not ${others.join(", ")}` : "",
  ];
  const angleUnit = radians || unit === "deg" ? unit : undefined;
  const own = { names, frames, channels, skeleton, frameTime, angleUnit };
  return { ...own, notes: notes.filter(Boolean), more };
}

/** Decode the first frames of a stream: (F,) of each column. */
async function decoded(mcz, index, models, assets, frames) {
  const { columns } = mcz.streams[index];
  if (frames * columns.length > MOST_VALUES) {
    throw new FileError("too many frames and channels", {
      expected: `a product of at most ${MOST_VALUES}`,
      found: `${frames} x ${columns.length}`,
    });
  }
  const channels = columns.map(() => new Float64Array(frames));
  for await (const chunk of decodeStream(mcz, index, models, assets)) {
    const end = Math.min(chunk.first + chunk.frames, frames);
    channels.forEach((channel, column) => {
      for (let frame = chunk.first, at = column; frame < end; frame++, at += columns.length) {
        channel[frame] = chunk.values[at];
      }
    });
    if (end === frames) break;
  }
  return channels;
}

async function markersOf(mcz, { columns, frameTime }, channels, frames, models, assets) {
  const found = async (name) => {
    const index = mcz.streams.findIndex((stream) => stream.name === name);
    if (index < 0) return null;
    const count = mcz.chunks[index].reduce((sum, chunk) => sum + chunk.frames, 0);
    return { stream: mcz.streams[index], values: await decoded(mcz, index, [], assets, count) };
  };
  const [cameras, analog] = [await found("cameras"), await found("analog")];
  // A point whose fourth word is below 0 is not valid, wherever it is stored.
  cameras?.values.forEach((seen, point) => {
    for (let frame = 0; frame < frames; frame++) {
      if (!(seen[frame] < 0)) continue;
      for (let axis = 0; axis < 3; axis++) channels[3 * point + axis][frame] = NaN;
    }
  });
  const described = await layoutOf(mcz, ["c3d", "trc"], assets);
  if (described?.kind === "trc") return describedTrc(described.layout, channels);
  if (described) {
    for (let i = 0; i < 8; i++) described.layout.integer(); // how the numbers are laid out
    const head = described.layout.prefixed();
    return describedC3d(channels, analog?.values ?? [], frames, head, assets);
  }
  if (columns.length % 3) {
    throw new FileError("points that are no places", { expected: "x, y and z of each" });
  }
  return markerClip({
    labels: columns.filter((_, i) => i % 3 === 0).map(({ name }) => name.replace(/\.x$/, "")),
    unit: columns[0].unit,
    places: channels,
    frames,
    frameTime,
    analog: (analog?.stream.columns ?? []).map(({ name, unit }, i) => ({
      name,
      unit,
      values: analog.values[i],
    })),
  });
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
