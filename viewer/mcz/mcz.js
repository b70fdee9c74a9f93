// Reads .mcz files: docs/format.md. Of what belongs to the original file, the layout is read if it is
// asked for.
import { chunksOfStreams, checkEnd, isChunk, readChunk } from "./chunks.js";
import { decoderOf } from "./decoding.js";
import { MczError } from "./error.js";
import { readHead } from "./head.js";
import { unpack } from "./packing.js";
import { Record } from "./record.js";
import { readSections, TAG } from "./sections.js";

const MOST_UNPACKED = 2 ** 24;
const DIGEST = 32; // bytes

/**
 * @typedef {Object} Mcz
 * @property {Object|null} skeleton
 * @property {import("./head.js").Stream[]} streams
 * @property {import("./chunks.js").Chunk[][]} chunks of each stream, in the order of their frames
 * @property {Record|undefined} original what belongs to the file that it was made of
 * @property {boolean} closed false: a recording that was not closed
 */

/**
 * Open a file: everything but the chunks' payloads is read and checked.
 *
 * @param {Uint8Array} bytes
 * @param {import("./assets.js").Assets} assets
 * @returns {Promise<Mcz>}
 * @throws {MczError} where it is damaged, has no motion, or is of a later version
 */
export async function openMcz(bytes, assets) {
  const { sections, closed } = readSections(bytes);
  const found = (tag) => sections.find((section) => section.tag === tag);
  const head = found(TAG.head);
  const chunks = sections.filter(isChunk).map(readChunk);
  if (!head) {
    const motion = chunks.length > 0 || !found(TAG.file);
    throw new MczError(motion ? "a file without a head" : "holds a file that is no motion");
  }
  const { skeleton, streams } = readHead(await unpack(head.content, MOST_UNPACKED, assets));
  const recording = !found(TAG.file) && streams.every(({ frames }) => frames === null);
  if (closed) checkEnd(found(TAG.end), chunks);
  else if (!recording) throw new MczError("the file is cut off", { offset: bytes.length });
  const own = chunksOfStreams(chunks, streams);
  checkValues(streams, own, bytes.length);
  return { skeleton, streams, chunks: own, closed, original: found(TAG.file)?.content };
}

/**
 * The layout of the file that a .mcz was made of, where it is of one of these formats.
 *
 * @param {Mcz} mcz
 * @param {string[]} kinds
 * @param {import("./assets.js").Assets} assets
 * @returns {Promise<{kind: string, layout: Record}|null>} docs/format/c3d.md and table.md
 */
export async function layoutOf({ original }, kinds, assets) {
  if (!original) return null;
  const record = new Record(original.bytes, original.name, original.begin);
  const kind = record.text();
  if (!kinds.includes(kind)) return null;
  record.text(); // its name
  record.integer(); // and size
  record.raw(DIGEST);
  for (let left = record.integer(); left; left--) {
    record.integer();
    record.text();
    record.text();
    record.integer();
    record.integer();
    record.text();
    record.text();
  }
  return { kind, layout: new Record(await unpack(record, MOST_UNPACKED, assets), "layout") };
}

/**
 * Decode a stream chunk by chunk.
 *
 * @param {Mcz} mcz
 * @param {number} stream
 * @param {Uint8Array[]} models `.mcm` files among which that is which the stream may name
 * @param {import("./assets.js").Assets} assets
 * @yields {{first: number, frames: number, values: Float64Array}} frames x columns, row by row
 */
export async function* decodeStream(mcz, stream, models, assets) {
  const told = mcz.streams[stream];
  const model = told.model.length
    ? await modelOf(told, models, assets)
    : new Uint8Array(0);
  const decode = await decoderOf(told, model, assets);
  for (const chunk of mcz.chunks[stream]) {
    yield { first: chunk.first, frames: chunk.frames, values: decode(chunk) };
  }
}

/** What is allocated is bounded by the file, not by what it announces. */
function checkValues(streams, chunks, length) {
  let values = 0;
  streams.forEach(({ columns = [] }, i) => {
    const frames = chunks[i].reduce((sum, chunk) => sum + chunk.frames, 0);
    values += frames * Math.max(columns.length, 1);
  });
  const most = 2 ** 22 + 2 ** 12 * length;
  if (values > most) {
    throw new MczError("too many numbers announced", { expected: `at most ${most}`, found: values });
  }
}

/** The payload of the model that a stream names; a wrong one shows in the chunks' digests. */
async function modelOf({ codec, model }, files, assets) {
  for (const file of files) {
    const [{ content: header }, { content }] = readSections(file, "\x89MCM").sections;
    const same = header.text() === codec && header.raw(model.length).every((b, i) => b === model[i]);
    if (same) return unpack(content, MOST_UNPACKED, assets);
  }
  throw new MczError("needs a model that is not here", { expected: "the .mcm that it was coded with" });
}
