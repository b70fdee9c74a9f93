// Decodes DiffMA JSON: T.-Y. Nagao, "DiffMA: A Lossy Encoding of Motion Capture Data for JSON" (2021).
// Runs in browsers and in Node, without dependencies. The format, with every rounding, is described in
// docs/guide/diffma_json.md of mocapress; all arithmetic is IEEE double in the order given there, so
// that the values are those of every other decoder, bit for bit.

import { DiffmaError, readDocument } from "./document.js";

export { DiffmaError };

const ALPHABET =
  "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz!#$%&()*+-;<=>?@^_`{|}~";
const NEG = 0;
const RAW = 1;
const EQL = 2;
const APX = 3;
const NO_OPCODE = 255;

const SYMBOLS = new Uint8Array(128).fill(NO_OPCODE);
for (let i = 0; i < ALPHABET.length; i++) SYMBOLS[ALPHABET.charCodeAt(i)] = i;

/**
 * Decodes a document, given as JSON text or as what `JSON.parse` made of it.
 *
 * With `bound`, the coarsest level of detail is taken whose bound is not above it, where the document
 * holds levels. Throws a DiffmaError, which names the place as a JSON path, when the document breaks
 * the format. Time and memory are proportional to the document's size.
 */
export function decode(source, options = {}) {
  const document = readDocument(source, options.bound);
  const { params, records, place } = document;
  const channels = records.b.map((text, c) => {
    const opcodes = readOpcodes(text, params.bits, `${place}.b[${c}]`);
    return decodeChannel(opcodes, records.t[c], params, c, place);
  });
  const frames = channels.length > 0 ? channels[0].length : 0;
  channels.forEach((values, c) => {
    if (values.length !== frames) {
      throw new DiffmaError(
        `${place}.b[${c}]`,
        `${frames} frames, as channel 0 has`,
        `${values.length}`,
      );
    }
  });
  const clip = { names: document.names, frames, channels, params };
  for (const key of ["skeleton", "frameTime", "layout"]) {
    if (document[key] !== undefined) clip[key] = document[key];
  }
  return clip;
}

// The numbers of the opcodes (Eq. 3.1). With more than 6 bits, the last symbols of the alphabet lead
// opcodes of two characters.
function readOpcodes(text, bits, path) {
  const leads = Math.max(0, Math.ceil((2 ** bits - 82) / 84));
  const single = ALPHABET.length - leads;
  const most = 2 ** bits + APX - 1;
  const opcodes = new Uint16Array(text.length);
  let count = 0;
  for (let at = 0; at < text.length; at++) {
    let opcode = symbolAt(text, at, path);
    if (opcode >= single) {
      at += 1;
      if (at === text.length) throw new DiffmaError(path, "a second character", "the end");
      opcode = single + (opcode - single) * ALPHABET.length + symbolAt(text, at, path);
    }
    if (opcode > most) {
      const found = `${JSON.stringify(text[at])} at ${at}`;
      throw new DiffmaError(path, `opcodes of ${bits} bits`, found);
    }
    opcodes[count++] = opcode;
  }
  return opcodes.subarray(0, count);
}

function symbolAt(text, at, path) {
  const code = text.charCodeAt(at);
  const symbol = code < 128 ? SYMBOLS[code] : NO_OPCODE;
  if (symbol === NO_OPCODE) {
    const found = `${JSON.stringify(text[at])} at ${at}`;
    throw new DiffmaError(path, "characters of the base85 alphabet (RFC 1924)", found);
  }
  return symbol;
}

// Algorithm 2. `order` 0 is the published algorithm: the prediction is the value before.
function decodeChannel(opcodes, table, params, c, place) {
  const path = `${place}.t[${c}]`;
  let negations = 0;
  let raws = 0;
  for (let i = 0; i < opcodes.length; i++) {
    if (opcodes[i] === NEG) negations += 1;
    else if (opcodes[i] === RAW) raws += 1;
  }
  if (opcodes.length === 0 && table.length === 0) return new Float64Array(0);
  if (table.length !== raws + 1) {
    throw new DiffmaError(path, `${raws + 1} numbers, one and one per RAW`, `${table.length}`);
  }
  const values = new Float64Array(opcodes.length - negations + 1);
  values[0] = table[0];
  const scale = (Array.isArray(params.bound) ? params.bound[c] : params.bound) / 2 ** params.bits;
  const order = Array.isArray(params.order) ? params.order[c] : params.order;
  fill(values, opcodes, table, scale, params.window, order);
  for (let i = 0; i < values.length; i++) {
    if (!Number.isFinite(values[i])) {
      throw new DiffmaError(`${place}.b[${c}]`, "finite values", `${values[i]} in frame ${i}`);
    }
  }
  return values;
}

// `sums` holds the steps of the block of `window` steps that has begun and, behind them, the sums of
// what is left of the block before: the mean of the last `window` steps is two numbers' sum away.
// Extension: with `order` > 0 the prediction continues the polynomial of this degree through the last
// values; the first `order` values behind the start are predicted by the one before, and no steps.
function fill(values, opcodes, table, scale, window, order) {
  const w = Math.min(window, values.length);
  const sums = new Float64Array(w + 1);
  const coefficients = extrapolation(order);
  let v = table[0];
  let [next, frame, at, prefix, count, mean, sign] = [1, 1, 0, 0, 0, 0, 1];
  for (let i = 0; i < opcodes.length; i++) {
    const opcode = opcodes[i];
    if (opcode === NEG) {
      sign = -sign;
      continue;
    }
    let predicted = v;
    if (order > 0 && frame > order) {
      predicted = 0;
      for (let k = 0; k <= order; k++) predicted += coefficients[k] * values[frame - 1 - k];
    }
    if (opcode === RAW) v = table[next++];
    else if (opcode === EQL) v = predicted;
    else v = predicted + sign * ((opcode - APX) * (mean * scale));
    values[frame++] = v;
    if (frame - 1 <= order) continue;
    const step = Math.abs(v - predicted);
    sums[at++] = step;
    prefix += step;
    if (count < w) count += 1;
    mean = (sums[at] + prefix) / count;
    if (at === w) {
      for (let k = w - 2; k >= 0; k--) sums[k] += sums[k + 1];
      at = 0;
      prefix = 0;
    }
  }
}

// (-1)^k C(order + 1, k + 1): 2, -1 for order 1; 3, -3, 1 for order 2.
function extrapolation(order) {
  const coefficients = [];
  let binomial = 1;
  for (let k = 0; k <= order; k++) {
    binomial = (binomial * (order + 1 - k)) / (k + 1);
    coefficients.push(k % 2 === 0 ? binomial : -binomial);
  }
  return coefficients;
}

// Reads the parts of a DiffMA document and checks them. Only own properties of the known names are
// looked at, and copied; nothing recurses into what a document nests.
