// Reads .mcz files: docs/format.md. Of what belongs to the original file, the layout is read if it is
// asked for.
import { chunksOfStreams, checkEnd, isChunk, readChunk } from "./chunks.js";
import { crc32 } from "./crc32.js";
import { decoderOf } from "./decoding.js";
import { MczError } from "./error.js";
import { readHead } from "./head.js";
import { STORED, unpack } from "./packing.js";
import { Record } from "./record.js";
import { readSections, sectionsOf, TAG } from "./sections.js";
import { joined } from "./xz.js";

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
 * The file of a clip whose parts a library keeps apart: docs/format/library.md.
 *
 * @param {Object} parts the columns `name`, `file`, `format`, `size`, `sha256`, `problems`, `head` and
 *     `layout` of `clips`; `skeleton`, the record, and its `sample`; `text`, packed; `sections` of
 *     `chunks`; each may be null
 * @param {import("./assets.js").Assets} assets
 * @returns {Promise<Mcz>} with the frames that the clip has in chunks of its own
 * @throws {MczError} where it is damaged
 */
export async function mczOfParts(parts, assets) {
  const unpacked = (bytes, what, beside) =>
    bytes ? unpack(new Record(bytes, what), MOST_UNPACKED, assets, beside) : Uint8Array.of(0);
  const sample = parts.sample ? await unpacked(soundSample(parts.sample), "sample") : undefined;
  const [skeletonRecord, rest] = await Promise.all([
    unpacked(parts.skeleton, "skeleton"),
    unpacked(parts.head, "head", sample),
  ]);
  const layout = parts.layout && (await unpacked(parts.layout, "layout", sample));
  const text = layout ? together(Uint8Array.of(STORED), integerOf(layout.length), layout) : parts.text;
  const { skeleton, streams } = readHead(together(skeletonRecord, rest));
  const sections = parts.sections ?? new Uint8Array(0);
  const chunks = chunksOfStreams(sectionsOf(sections).filter(isChunk).map(readChunk), streams);
  checkValues(streams, chunks, sections.length);
  return { skeleton, streams, chunks, closed: true, original: originalOf({ ...parts, text }) };
}

/** The sample of a skeleton, packed, without its checksum. */
function soundSample(sample) {
  const packed = sample.subarray(4);
  const stored = new DataView(sample.buffer, sample.byteOffset).getUint32(0, true);
  if (crc32(packed) !== stored) throw new MczError("damaged: the sample of a skeleton");
  return packed;
}

/** The section *file* as `layoutOf` reads it. */
function originalOf({ name, file, format, size, sha256, problems, text }) {
  if (!text) return undefined;
  const named = (words) => {
    const bytes = new TextEncoder().encode(words);
    return together(integerOf(bytes.length), bytes);
  };
  const own = file ?? name.slice(name.lastIndexOf("/") + 1);
  const described = [named(format ?? ""), named(own), integerOf(size), sha256];
  return new Record(together(...described, problems ?? Uint8Array.of(0), text), "file");
}

function together(...pieces) {
  return joined(pieces, pieces.reduce((sum, { length }) => sum + length, 0));
}

function integerOf(value) {
  const bytes = [];
  for (; value > 127; value = Math.floor(value / 128)) bytes.push((value % 128) | 128);
  return Uint8Array.of(...bytes, value);
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
