import { FileError } from "./file_error.js";
import { markerClip } from "./markers.js";
import { formats } from "./motion_file.js";

const [DEC, MIPS] = [85, 86];
const [TEXT, BYTE, INTEGER, REAL] = [-1, 1, 2, 4];
const IN_POINT = 4;
const NO_PLACES = ["ANGLES", "FORCES", "MOMENTS", "POWERS", "SCALARS"];
const MOST_NUMBERS = 5e7; // 400 MB

/**
 * Read a C3D file.
 *
 * @param {Uint8Array} bytes
 * @param {import("../../mcz/assets.js").Assets} assets
 * @returns {Promise<import("./clip.js").Clip>}
 * @throws {FileError} where its frames cannot be found, or some are missing
 */
export async function readC3d(bytes, assets) {
  const layout = (await formats(assets)).c3d(bytes);
  const [begin, frames, numbers] = layout.frames;
  const { announced, points, analog, samples } = layout;
  if (!frames) {
    const turns = layout.rotations[1];
    throw new FileError(turns ? "only rotations, which are not shown" : "the frames cannot be found");
  }
  if (frames < announced) {
    const found = String(frames);
    throw new FileError("the file ends before its last frame", { expected: `${announced} frames`, found });
  }
  if (frames * numbers > MOST_NUMBERS) {
    throw new FileError("too many frames and numbers", {
      expected: `a product of at most ${MOST_NUMBERS}`,
      found: `${frames} x ${numbers}`,
    });
  }
  const size = layout.floats ? REAL : INTEGER;
  const numberAt = layout.floats ? reals(bytes, layout) : integers(bytes, layout);
  const columns = (count, length) => Array.from({ length: count }, () => new Float64Array(length));
  const places = columns(3 * points, frames);
  const channels = columns(analog / samples, frames * samples);
  for (let frame = 0, at = begin; frame < frames; frame++) {
    for (let point = 0; point < points; point++, at += IN_POINT * size) {
      const [x, y, z] = [numberAt(at), numberAt(at + size), numberAt(at + 2 * size)];
      const missing = numberAt(at + 3 * size) < 0;
      places[3 * point][frame] = missing ? NaN : x;
      places[3 * point + 1][frame] = missing ? NaN : y;
      places[3 * point + 2][frame] = missing ? NaN : z;
    }
    for (let sample = 0; sample < samples; sample++) {
      for (const channel of channels) {
        channel[frame * samples + sample] = numberAt(at);
        at += size;
      }
    }
  }
  const clip = described(places, channels, frames, new Parameters(bytes, layout));
  return frames > announced && announced < 2 ** 16 - 1
    ? { ...clip, notes: ["more frames than the header announces", ...clip.notes] }
    : clip;
}

/**
 * Make a clip of the numbers of a C3D file and what stands before them.
 *
 * @param {Float64Array[]} places of each point x, y and z, as they are stored; NaN where missing
 * @param {Float64Array[]} channels of analog data
 * @param {number} frames
 * @param {Uint8Array} head
 */
export async function describedC3d(places, channels, frames, head, assets) {
  const layout = (await formats(assets)).c3d(head);
  return described(places, channels, frames, new Parameters(head, layout));
}

function described(places, channels, frames, told) {
  const scale = told.floats ? 1 : Math.abs(told.number("POINT", "SCALE", told.realAt(12))) || 1;
  if (scale !== 1) for (const place of places) scaled(place, 0, scale);
  const factor = told.number("ANALOG", "GEN_SCALE", 1);
  const [factors, zeros] = [told.numbers("ANALOG", "SCALE"), told.numbers("ANALOG", "OFFSET")];
  const unsigned = told.texts("ANALOG", "FORMAT").join("").toUpperCase().startsWith("UNSIGNED");
  channels.forEach((channel, i) => {
    const zero = zeros[i] ?? 0;
    scaled(channel, unsigned && zero < 0 ? zero + 2 ** 16 : zero, factor * (factors[i] ?? 1));
  });
  const [names, units] = [told.texts("ANALOG", "LABELS"), told.texts("ANALOG", "UNITS")];
  return markerClip({
    labels: named(told.texts("POINT", "LABELS"), places.length / 3),
    unit: told.texts("POINT", "UNITS")[0] ?? "",
    places,
    frames,
    frameTime: told.frameTime,
    noPlaces: new Set(NO_PLACES.flatMap((name) => told.texts("POINT", name))),
    analog: channels.map((values, i) => ({
      name: names[i] || `*${i + 1}`,
      unit: units[i] ?? (units.length === 1 ? units[0] : ""),
      values,
    })),
  });
}

function scaled(values, zero, factor) {
  for (let i = 0; i < values.length; i++) values[i] = (values[i] - zero) * factor;
}

function named(labels, count) {
  return Array.from({ length: count }, (_, i) => labels[i] || `*${i + 1}`);
}

function integers(bytes, { processor }) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  return (at) => view.getInt16(at, processor !== MIPS);
}

/** Reads floats; the halves of a DEC float are swapped, its exponent is two higher. */
function reals(bytes, { processor }) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  if (processor !== DEC) return (at) => view.getFloat32(at, processor !== MIPS);
  const one = new DataView(new ArrayBuffer(4));
  return (at) => {
    one.setUint16(0, view.getUint16(at, true));
    one.setUint16(2, view.getUint16(at + 2, true));
    return one.getFloat32(0) / 4;
  };
}

/** The parameters of a file, by group and name in capitals, as the core found them. */
class Parameters {
  constructor(bytes, layout) {
    this.floats = layout.floats;
    this.bytes = bytes;
    this.integerAt = integers(bytes, layout);
    this.realAt = reals(bytes, layout);
    this.groups = new Map();
    const names = new Map();
    for (const { group, isGroup, name } of layout.parameters) {
      if (isGroup && !names.has(group)) names.set(group, name.trim().toUpperCase());
    }
    for (const parameter of layout.parameters) {
      if (parameter.isGroup) continue;
      const key = `${names.get(parameter.group)}:${parameter.name.trim().toUpperCase()}`;
      if (!this.groups.has(key)) this.groups.set(key, parameter);
    }
  }

  numbers(group, name) {
    const found = this.groups.get(`${group}:${name}`);
    if (!found || ![BYTE, INTEGER, REAL].includes(found.type)) return [];
    const take = { [BYTE]: (at) => this.bytes[at], [INTEGER]: this.integerAt, [REAL]: this.realAt };
    const count = Math.floor(found.size / found.type);
    return Array.from({ length: count }, (_, i) => take[found.type](found.begin + i * found.type));
  }

  number(group, name, usual) {
    const [first] = this.numbers(group, name);
    return Number.isFinite(first) ? first : usual;
  }

  /** The texts of a parameter and of those that continue it: LABELS, LABELS2 ... */
  texts(group, name) {
    const found = [];
    for (let place = 1; place < 256; place++) {
      const own = this.groups.get(`${group}:${name}${place === 1 ? "" : place}`);
      if (own?.type !== TEXT) break;
      const width = own.dimensions.length ? own.dimensions[0] : own.size;
      for (let at = 0; width && at < own.size; at += width) {
        found.push(textOf(this.bytes.subarray(own.begin + at, own.begin + Math.min(at + width, own.size))));
      }
    }
    return found;
  }

  /** Seconds per frame; null where nothing says them. */
  get frameTime() {
    for (const rate of [this.number("POINT", "RATE", 0), this.realAt(20)]) {
      // As Python has them: of the shortest decimal that gives the float.
      if (rate > 0 && rate < 1e9) return 1 / shortest(rate);
    }
    return null;
  }
}

function shortest(real) {
  for (let digits = 1; digits <= 9; digits++) {
    const decimal = Number(real.toPrecision(digits));
    if (Math.fround(decimal) === Math.fround(real)) return decimal;
  }
  return real;
}

function textOf(bytes) {
  let text;
  try {
    text = new TextDecoder("utf-8", { fatal: true }).decode(bytes);
  } catch {
    text = new TextDecoder("latin1").decode(bytes);
  }
  return text.replace(/[\0-\x1f]+/g, " ").trim();
}
