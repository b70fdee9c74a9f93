import { MczError } from "./error.js";
import { joined, unpackLzma2 } from "./xz.js";

export const STORED = 0;
const [LZMA2, DEFLATE] = [1, 2];

/**
 * Take packed content, which is the rest of a record.
 *
 * @param {import("./record.js").Record} record
 * @param {number} most bytes that may come out
 * @param {import("./assets.js").Assets} assets
 * @param {Uint8Array} [beside] what it was packed beside, in a library
 * @returns {Promise<Uint8Array>}
 */
export async function unpack(record, most, assets, beside = new Uint8Array(0)) {
  const method = record.integer(DEFLATE);
  const size = record.integer(most);
  const packed = record.raw(record.left);
  let data = packed;
  try {
    if (method === LZMA2) {
      const dictionary = Math.min(Math.max(2 ** Math.ceil(Math.log2(size || 1)), 2 ** 12), 2 ** 26);
      data = unpackLzma2(await assets.module("vendor/xz/xz.wasm"), packed, dictionary, size);
    } else if (method !== STORED) {
      const known = await assets.bytes("dictionary1.bin");
      const dictionary = joined([known, beside], known.length + beside.length);
      data = await inflate(packed, dictionary, size);
    }
  } catch (error) {
    if (error instanceof MczError) throw record.fail(error.message);
    throw error;
  }
  if (data.length !== size) throw record.fail(`unpacks to ${data.length} bytes, not ${size}`);
  return data;
}

/** Undo raw deflate with a preset dictionary: it stands in front, as a block that is not packed. */
async function inflate(packed, dictionary, most) {
  const { length } = dictionary;
  const head = [0, length & 255, length >> 8, ~length & 255, (~length >> 8) & 255];
  const stream = new Blob([Uint8Array.from(head), dictionary, packed])
    .stream()
    .pipeThrough(new DecompressionStream("deflate-raw"));
  const pieces = [];
  let size = 0;
  try {
    for (const reader = stream.getReader(); ; ) {
      const { done, value } = await reader.read();
      if (done) break;
      pieces.push(value);
      size += value.length;
      if (size > length + most) {
        await reader.cancel();
        throw new MczError("unpacks to too much", { expected: `at most ${most} bytes` });
      }
    }
  } catch (error) {
    if (error instanceof MczError) throw error;
    // Engines differ in what they throw here.
    throw new MczError("packed data is damaged or cut off");
  }
  return joined(pieces, size).subarray(length);
}
