import { crc32 } from "./crc32.js";
import { MczError } from "./error.js";
import { instantiate } from "./instance.js";
import { unpackLzma2 } from "./xz.js";

const MOST_CHUNK = 2 ** 20;
const DIFFMA_DICTIONARY = 2 ** 20;
const DIFFMA_MOST_BYTES = 32; // of a value's text
const ALPHAS = {
  "k2-non-uniform": [-2, -0.5, 0, 0.5],
  "k3-uniform": [-1.75, -1.25, -0.75, -0.25, 0.25, 0.75, 1.25, 1.75],
  "k3-non-uniform": [-1, -0.5, -0.25, 0, 0.25, 0.5, 1, 2],
  "k4-non-uniform": [
    -2, -1.25, -1, -0.75, -0.5, -0.25, -0.125, 0, 0.125, 0.25, 0.5, 0.75, 1, 1.25, 2, 5,
  ],
};

// Of `exact`, as in core/exact/codec.hpp.
const USUAL_LEVEL = 5;

// Of each codec: what its module is told (core/wasm), and the most frames that a chunk has.
const CODECS = {
  exact(own) {
    const told = [whole(own, "level", USUAL_LEVEL, 9)];
    return { told, most: whole(own, "chunk", 512, MOST_CHUNK) };
  },
  app(own) {
    const alphas = Object.hasOwn(ALPHAS, own.table) ? ALPHAS[own.table] : undefined;
    if (own.table !== undefined && !alphas) throw new MczError("app:table", { found: own.table });
    const cluster = whole(own, "t", 15, MOST_CHUNK);
    const chunk = whole(own, "chunk", 480, MOST_CHUNK);
    const told = [cluster, whole(own, "mantissa_limit", 12, 53)];
    const most = Math.ceil(chunk / cluster) * cluster;
    return { told: [...told, ...(alphas ?? ALPHAS["k3-non-uniform"])], most };
  },
  mrpa(own) {
    // In mode "published" a chunk is a segment, of any length.
    const most = own.mode === "published" ? MOST_CHUNK : whole(own, "chunk", 480, MOST_CHUNK);
    return { told: [whole(own, "mantissa_limit", 53, 53)], most };
  },
  diffma(own) {
    const told = [whole(own, "bits", 6, 12), whole(own, "window", 64, MOST_CHUNK)];
    return { told, most: whole(own, "chunk", 2048, MOST_CHUNK), packed: true };
  },
  near(own) {
    return { told: [], most: whole(own, "chunk", 1024, MOST_CHUNK) };
  },
  patterns(own) {
    return { told: [], most: whole(own, "chunk", 2048, MOST_CHUNK) };
  },
  qssd(own) {
    return { told: [], most: whole(own, "chunk", 2048, MOST_CHUNK) };
  },
};

function whole(parameters, name, usual, most) {
  const value = parameters[name] ?? usual;
  if (!Number.isInteger(value) || value < 1 || value > most) {
    throw new MczError(`codec parameter ${name}`, { expected: `1 to ${most}`, found: value });
  }
  return value;
}

/** The files that decoding a stream needs, beside this code. */
export function assetsOf({ codec }) {
  if (!Object.hasOwn(CODECS, codec)) {
    throw new MczError("coded by a codec that this page does not know", { found: codec });
  }
  return [`wasm/${codec}.wasm`, ...(codec === "diffma" ? ["vendor/xz/xz.wasm"] : [])];
}

/**
 * Make a decoder of a stream's chunks.
 *
 * @param {import("./head.js").Stream} stream
 * @param {Uint8Array} model its payload; empty where the stream names none
 * @param {import("./assets.js").Assets} assets
 * @returns {Promise<function(import("./chunks.js").Chunk): Float64Array>} gives frames x columns
 *     values, row by row; throws MczError where the chunk is not what an encoder makes
 */
export async function decoderOf(stream, model, assets) {
  const [module, xz] = await Promise.all(assetsOf(stream).map((name) => assets.module(name)));
  const { told, most, packed } = CODECS[stream.codec](stream.parameters);
  const columns = stream.columns.length;
  const instance = instantiate(module);
  return (chunk) => {
    const where = `chunk of frames ${chunk.first} to ${chunk.first + chunk.frames - 1}`;
    const fail = (what) => new MczError(`${where}: ${what}`, { offset: chunk.begin });
    if (chunk.frames > most) throw fail(`more frames than the ${most} of a chunk`);
    try {
      const limit = DIFFMA_MOST_BYTES * columns * chunk.frames;
      const payload = packed
        ? unpackLzma2(xz, chunk.payload, DIFFMA_DICTIONARY, limit)
        : chunk.payload;
      const header = chunk.header ?? stream.header;
      const values = decode(instance, told, { ...stream, header, model, payload }, chunk.frames);
      if (crc32(new Uint8Array(values.buffer)) !== chunk.digest) {
        throw new MczError("decodes to other values than were coded");
      }
      return values;
    } catch (error) {
      if (error instanceof MczError) throw fail(error.message);
      if (error instanceof WebAssembly.RuntimeError) throw fail("does not decode, or needs too much memory");
      throw error;
    }
  };
}

function decode({ exports }, told, { columns, formats, header, model, payload }, frames) {
  const parts = [formats, header, model, payload];
  const space = exports.space(8 * told.length + parts.reduce((sum, part) => sum + part.length, 0));
  new Float64Array(exports.memory.buffer, space, told.length).set(told);
  let at = space + 8 * told.length;
  for (const part of parts) {
    new Uint8Array(exports.memory.buffer).set(part, at);
    at += part.length;
  }
  const sizes = [told.length, header.length, model.length, payload.length];
  const values = exports.decode(columns.length, frames, ...sizes);
  return new Float64Array(exports.memory.buffer, values, columns.length * frames).slice();
}
