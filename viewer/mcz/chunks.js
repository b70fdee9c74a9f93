import { MczError } from "./error.js";
import { TAG } from "./sections.js";

const MOST_STREAMS = 256;
const MOST_FRAMES = 2 ** 40;
const [CONTINUES, OWN_HEADER, NEEDS, FLAGS] = [1, 2, 4, 8];

/**
 * @typedef {Object} Chunk
 * @property {number} flags first field of the chunk
 * @property {number} stream
 * @property {number} first frame
 * @property {number} frames
 * @property {number} digest CRC-32 of the decoded values
 * @property {Uint8Array|null} header the codec header that is its own
 * @property {Uint8Array} payload
 */

/** @returns {Chunk} */
export function readChunk({ content, begin, end }) {
  const flags = content.integer(FLAGS * MOST_STREAMS - 1);
  const [first, frames] = [content.integer(MOST_FRAMES), content.integer(MOST_FRAMES)];
  const digest = content.uint32();
  const header = flags & OWN_HEADER ? content.prefixed() : null;
  const stream = Math.floor(flags / FLAGS);
  if (frames === 0) throw new MczError("a chunk without frames", { offset: begin });
  if (flags & CONTINUES) {
    throw new MczError("a chunk that needs others, which this page cannot decode", { offset: begin });
  }
  if (flags & NEEDS) {
    throw new MczError("a chunk that needs frames of other clips, which only its library has", {
      offset: begin,
      expected: "a file written by 'mocapress library export', which needs none",
    });
  }
  const payload = content.raw(content.left);
  return { flags, stream, first, frames, digest, header, payload, begin, end };
}

/** See that the end section announces these chunks. */
export function checkEnd({ content, begin, end }, chunks) {
  const differs = (what) => new MczError(`the end of the file: ${what}`, { offset: begin });
  const count = content.integer(content.left);
  if (count !== chunks.length) throw differs(`${count} chunks announced, ${chunks.length} found`);
  const lists = [0, 1, 2].map(() => content.runs(count, () => content.integer()));
  const lengths = content.list(count, () => content.integer());
  let before = 0;
  chunks.forEach((chunk, i) => {
    const found = [chunk.flags, chunk.frames, chunk.begin - before, chunk.end - chunk.begin];
    before = chunk.end;
    if ([lists[0][i], lists[1][i], lists[2][i], lengths[i]].some((value, k) => value !== found[k])) {
      throw differs(`announces another chunk than number ${i + 1}`);
    }
  });
  if (content.uint32() !== end - begin) throw differs("wrong distance");
  content.end();
}

/**
 * The chunks of each stream, which must follow each other.
 *
 * @param {Chunk[]} chunks
 * @param {import("./head.js").Stream[]} streams
 * @returns {Chunk[][]}
 */
export function chunksOfStreams(chunks, streams) {
  const made = streams.map(() => []);
  const reached = streams.map(() => 0);
  for (const { stream, first, frames, begin } of chunks) {
    if (stream >= streams.length) throw new MczError("a chunk of no stream", { offset: begin });
    if (first !== reached[stream]) {
      throw new MczError("chunks in the wrong order", {
        offset: begin,
        expected: `frame ${reached[stream]}`,
        found: first,
      });
    }
    reached[stream] += frames;
  }
  for (const chunk of chunks) made[chunk.stream].push(chunk);
  streams.forEach(({ name, frames }, i) => {
    if (typeof frames === "number" && frames !== reached[i]) {
      throw new MczError(`chunks of stream '${name}'`, { expected: `${frames} frames`, found: reached[i] });
    }
  });
  return made;
}

export function isChunk({ tag }) {
  return tag === TAG.chunk;
}
