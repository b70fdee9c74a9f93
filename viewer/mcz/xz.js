import { crc32 } from "./crc32.js";
import { MczError } from "./error.js";

// Of xz-embedded, which knows .xz files but no raw LZMA2.
const OK = 0;
const STREAM_END = 1;
const LEAST_DICTIONARY = 12; // binary logarithm

/**
 * Unpack raw LZMA2.
 *
 * @param {WebAssembly.Module} module viewer/vendor/xz/xz.wasm
 * @param {Uint8Array} packed
 * @param {number} dictionary its size, a power of two from 4 KiB on
 * @param {number} most bytes that may come out
 * @returns {Uint8Array}
 * @throws {MczError} where it is damaged, cut off, followed by something, or too long
 */
export function unpackLzma2(module, packed, dictionary, most) {
  const size = unpackedSize(packed);
  if (size > most) throw new MczError("unpacks to too much", { expected: `at most ${most} bytes` });
  return unpackXz(module, framed(packed, Math.log2(dictionary), size), size);
}

/** Unpack an .xz file of at most so many bytes. */
export function unpackXz(module, file, most) {
  const { exports } = new WebAssembly.Instance(module);
  const context = exports.create_context();
  const fields = () => new Uint32Array(exports.memory.buffer, context);
  const pieces = [];
  let size = 0;
  for (let at = 0, code = OK; code !== STREAM_END; ) {
    const [room, input, taken, given, output] = fields();
    if (taken === given) {
      const piece = file.subarray(at, at + room);
      new Uint8Array(exports.memory.buffer).set(piece, input);
      exports.supply_input(context, piece.length);
      at += piece.length;
    }
    code = exports.get_next_output(context);
    const made = fields()[5];
    size += made;
    if ((code !== OK && code !== STREAM_END) || size > most) {
      throw new MczError("packed data is damaged", { found: `code ${code} of the unpacker` });
    }
    pieces.push(new Uint8Array(exports.memory.buffer, output, made).slice());
    fields()[5] = 0;
  }
  return joined(pieces, size);
}

export function joined(pieces, size) {
  const all = new Uint8Array(size);
  let at = 0;
  for (const piece of pieces) {
    all.set(piece, at);
    at += piece.length;
  }
  return all;
}

/** What LZMA2's chunks announce; they must end where the data does. */
function unpackedSize(packed) {
  let size = 0;
  for (let at = 0; at < packed.length; ) {
    const control = packed[at];
    if (control === 0) {
      if (at + 1 < packed.length) break;
      return size;
    }
    const low = 256 * packed[at + 1] + packed[at + 2] + 1;
    if (control < 0x80) {
      size += low;
      at += 3 + low;
    } else {
      size += low + ((control & 0x1f) << 16);
      at += (control < 0xc0 ? 5 : 6) + 256 * packed[at + 3] + packed[at + 4] + 1;
    }
  }
  throw new MczError("packed data is cut off, or followed by something");
}

/** An .xz file of one block, without a check of its own. */
function framed(packed, dictionary, size) {
  const flags = [0, 0];
  const head = [0x02, 0, 0x21, 1, 2 * (dictionary - LEAST_DICTIONARY), 0, 0, 0];
  const block = [...head, ...le32(crc32(head))];
  const index = padded([0, 1, ...leb128(block.length + packed.length), ...leb128(size)]);
  index.push(...le32(crc32(index)));
  const foot = [...le32(index.length / 4 - 1), ...flags];
  return joined(
    [
      Uint8Array.of(0xfd, 0x37, 0x7a, 0x58, 0x5a, 0, ...flags, ...le32(crc32(flags)), ...block),
      packed,
      new Uint8Array(-packed.length & 3),
      Uint8Array.of(...index, ...le32(crc32(foot)), ...foot, 0x59, 0x5a),
    ],
    12 + block.length + packed.length + (-packed.length & 3) + index.length + 12,
  );
}

function padded(bytes) {
  while (bytes.length % 4) bytes.push(0);
  return bytes;
}

function le32(value) {
  return [0, 8, 16, 24].map((shift) => (value >>> shift) & 255);
}

function leb128(value) {
  const bytes = [];
  for (; value > 127; value = Math.floor(value / 128)) bytes.push((value % 128) | 128);
  return [...bytes, value];
}
