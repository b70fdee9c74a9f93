// What a library keeps of a clip to compare it (docs/search.md, Record).
import { FileError } from "./file_error.js";

export const RATE = 15; // rows a second
export const SIZE = 35;
const [PLACES, KEPT, FINE, SPEED] = [15, 20, 64, 0.25];
const MOST = 2 ** 26;

/**
 * @typedef {Object} Features
 * @property {number} frames
 * @property {Float32Array} values frames x SIZE
 */

/** @type {Features} */
export const NOTHING = { frames: 0, values: new Float32Array() };

/**
 * Read a record.
 *
 * @param {Uint8Array} record
 * @returns {Promise<Features>}
 * @throws {FileError} when it is damaged
 */
export async function readRecord(record) {
  const damaged = () => new FileError("damaged: what search compares of a clip");
  if (record.length < 4) throw damaged();
  const frames = new DataView(record.buffer, record.byteOffset, 4).getUint32(0, true);
  if (frames > MOST) throw damaged();
  const steps = await inflated(record.subarray(4), frames * (KEPT + 1)).catch(() => null);
  const rows = steps && frames ? steps.length / frames : KEPT;
  if (!steps || (rows !== KEPT && rows !== KEPT + 1)) throw damaged();
  for (let i = 0; i < KEPT * frames; ++i) if (i % frames) steps[i] += steps[i - 1];
  const values = new Float32Array(frames * SIZE);
  const begins = rows > KEPT ? steps.subarray(KEPT * frames) : new Int8Array(frames);
  for (let i = 0; i < frames; ++i) {
    const before = i > 0 && !begins[i] ? i - 1 : i;
    const behind = i + 1 < frames && !begins[i + 1] ? i + 1 : i;
    const by = behind > before ? (SPEED * RATE) / ((behind - before) * FINE) : 0;
    for (let k = 0; k < KEPT; ++k) {
      const own = steps.subarray(k * frames, (k + 1) * frames);
      values[i * SIZE + (k < PLACES ? k : k + PLACES)] = own[i] / FINE;
      if (k < PLACES) values[i * SIZE + PLACES + k] = by * (own[behind] - own[before]);
    }
  }
  return { frames, values };
}

/** Give some frames. */
export function part({ values }, first, last) {
  return { frames: last - first, values: values.subarray(first * SIZE, last * SIZE) };
}

async function inflated(packed, most) {
  const made = new Int8Array(most);
  let size = 0;
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  for (const reader = stream.getReader(); ; ) {
    const { done, value } = await reader.read();
    if (done) return made.subarray(0, size);
    if (size + value.length > most) {
      await reader.cancel();
      throw new FileError("unpacks to too much");
    }
    made.set(value, size);
    size += value.length;
  }
}
