import { Record } from "./record.js";

// docs/format.md, "Limits".
const MOST = { streams: 256, parameters: 64, joints: 2 ** 16, columns: 2 ** 18, kinds: 64 };
const KINDS = ["tx", "ty", "tz", "rx", "ry", "rz", "l", "sx", "sy", "sz"];
const MODEL_NAME = 32;
const MOST_DIGITS = 40;

/**
 * @typedef {Object} Stream
 * @property {string} name
 * @property {string} kind of others than `channels` only name and kind are known
 * @property {number|null} frames null in a recording
 * @property {number|null} frameTime seconds
 * @property {{name: string, joint: number, kind: string, unit: string, bone?: string}[]} columns
 *     bone: its name in the source, where columns take their names from bones
 * @property {Uint8Array} formats of each column how it was printed: kind and digits
 * @property {string} codec
 * @property {Object<string, number|string|boolean>} parameters
 * @property {Uint8Array} model name of the model that decoding needs, or nothing
 * @property {Uint8Array} header of the codec
 */

/**
 * Read the head.
 *
 * @param {Uint8Array} content unpacked
 * @returns {{skeleton: Object|null, streams: Stream[]}}
 */
export function readHead(content) {
  const record = new Record(content, "head");
  const skeleton = readSkeleton(record);
  const streams = record.list(record.integer(MOST.streams), () => {
    const [name, kind] = [record.text(), record.text()];
    const own = new Record(record.prefixed(), `stream '${name}'`);
    return kind === "channels" ? readStream(own, name, skeleton) : { name, kind };
  });
  record.end();
  if (!streams.length || new Set(streams.map(({ name }) => name)).size < streams.length) {
    throw record.fail("no streams, or two of one name");
  }
  return { skeleton, streams };
}

function readSkeleton(record) {
  const count = record.integer(MOST.joints);
  if (count === 0) return null;
  const flags = record.integer(31);
  record.text(); // its name
  for (let facts = record.count(2); facts > 0; facts--) {
    record.text();
    record.text();
  }
  const lengthUnit = flags & 4 ? record.double() : null;
  const names = record.list(count, () => record.text());
  const parents = record.list(count, (index) => index - 1 - record.integer(index));
  const channels = record.list(count, () => [...record.prefixed()].map((code) => kindOf(record, code)));
  const ends = record.list(count, () => record.count());
  const vectors = vectorsOf(record, ends.reduce((a, b) => a + b, count));
  const orders = flags & 8 ? record.list(count, () => axisOrder(record)) : names.map(() => "xyz");
  const axes = flags & 8 ? vectorsOf(record, count) : names.map(() => [0, 0, 0]);
  if (flags & 16) {
    const limited = record.list(count, (index) => record.integer(channels[index].length));
    record.numbers(2 * limited.reduce((a, b) => a + b, 0));
  }
  let at = 0;
  const joints = names.map((name, index) => {
    const [offset, ...own] = vectors.slice(at, at + 1 + ends[index]);
    at += 1 + ends[index];
    return {
      name,
      parent: parents[index],
      offset,
      channels: channels[index],
      axis: axes[index],
      axisOrder: orders[index],
      ends: own,
    };
  });
  const rotation = flags & 1 ? "fixed" : "moving";
  return { rotation, angleUnit: flags & 2 ? "rad" : "deg", lengthUnit, joints };
}

function kindOf(record, code) {
  if (code >= KINDS.length) throw record.fail("a channel of no kind");
  return KINDS[code];
}

function axisOrder(record) {
  const order = [...record.prefixed()].map((code) => "xyz"[code]).join("");
  if ([...order].sort().join("") !== "xyz") throw record.fail("no order of axes");
  return order;
}

function vectorsOf(record, count) {
  const numbers = record.numbers(3 * count);
  return Array.from({ length: count }, (_, i) => numbers.slice(3 * i, 3 * i + 3));
}

function readStream(record, name, skeleton) {
  const frames = record.integer();
  const frameTime = readTime(record);
  const columns = readColumns(record, skeleton);
  const formats = readFormats(record, columns.length);
  const codec = record.text();
  const parameters = {};
  for (let count = record.integer(MOST.parameters); count > 0; count--) {
    const key = record.text();
    Object.defineProperty(parameters, key, { value: readParameter(record), configurable: true });
  }
  const [model, header] = [record.prefixed(), record.prefixed()];
  record.end();
  if (model.length && model.length !== MODEL_NAME) throw record.fail("no name of a model");
  const own = { codec, parameters, model, header };
  return { name, kind: "channels", frames: frames ? frames - 1 : null, frameTime, columns, formats, ...own };
}

function readTime(record) {
  const form = record.integer(2);
  if (form === 0) return null;
  const first = record.wide(448);
  if (form === 1) {
    const exponent = record.signed();
    if (Math.abs(exponent) > 512) throw record.fail("no frame time");
    return Number(`${first}e${exponent}`);
  }
  const denominator = record.wide(448);
  if (denominator === 0n) throw record.fail("no frame time");
  return Number(first) / Number(denominator);
}

function readParameter(record) {
  switch (record.byte()) {
    case 0:
      return record.signed();
    case 1:
      return record.double();
    case 2:
      return record.text();
    case 3:
      return record.integer(1) === 1;
    default:
      throw record.fail("a parameter of no type");
  }
}

/** Columns, which take their names from joints or bones, or have their own. */
function readColumns(record, skeleton) {
  const count = record.integer(MOST.columns);
  const form = record.integer(3);
  let columns;
  if (form === 0) {
    const joints = skeleton?.joints ?? [];
    const bones = joints.map(({ name, channels }, joint) => ({ name, joint, count: channels.length }));
    const kinds = joints.flatMap((joint) => joint.channels);
    const unitOf = { r: skeleton?.angleUnit, t: "length", l: "length" };
    const units = kinds.map((kind) => unitOf[kind[0]] ?? "");
    if (kinds.length !== count) throw record.fail(`${count} columns of ${kinds.length} channels`);
    columns = columnsOf(bones, kinds, units);
  } else if (form === 1) {
    const bones = readBones(record, count);
    columns = columnsOf(bones, ...readKinds(record, count));
  } else if (form === 3) {
    const kinds = record.list(record.integer(MOST.kinds), () => record.text());
    if (!kinds.length || count % kinds.length) {
      throw record.fail(`${count} columns in groups of ${kinds.length}`);
    }
    columns = Array.from({ length: count }, (_, i) => {
      const kind = kinds[i % kinds.length];
      return { name: `${Math.floor(i / kinds.length) + 1}.${kind}`, joint: -1, kind, unit: "" };
    });
  } else {
    const names = record.list(count, () => record.text());
    const joints = record.runs(count, () => record.integer(MOST.joints));
    const [kinds, units] = readKinds(record, count);
    columns = names.map((name, i) => ({ name, joint: joints[i] - 1, kind: kinds[i], unit: units[i] }));
  }
  const joints = skeleton ? skeleton.joints.length : MOST.joints;
  if (columns.some(({ joint }) => joint < -1 || joint >= joints)) throw record.fail("a column of no joint");
  return columns;
}

function readBones(record, columns) {
  let [expected, left] = [0, columns];
  const bones = record.list(record.integer(columns), () => {
    const [name, count] = [record.text(), record.integer(left)];
    if (count === 0) throw record.fail("a bone without columns");
    const joint = expected + record.signed();
    expected = joint + 1;
    left -= count;
    return { name, joint, count };
  });
  if (left) throw record.fail(`${left} columns of no bone`);
  return bones;
}

function readKinds(record, count) {
  return [record.list(count, () => record.text()), record.runs(count, () => record.text())];
}

function columnsOf(bones, kinds, units) {
  const seen = new Map();
  const columns = [];
  for (const { name, joint, count } of bones) {
    if (!count) continue;
    const nth = (seen.get(name) ?? 0) + 1;
    seen.set(name, nth);
    const label = nth === 1 ? name : `${name}#${nth}`;
    for (let end = columns.length + count; columns.length < end; ) {
      const kind = kinds[columns.length];
      const unit = units[columns.length];
      columns.push({ name: `${label}.${kind}`, joint, kind, unit, bone: name });
    }
  }
  return columns;
}

/** How the source printed the numbers, kind and digits of each column; without one, as kind 4. */
function readFormats(record, count) {
  const known = record.list(record.count(4), () => {
    const [kind, digits, exponent, flags] = record.raw(4);
    const most = kind === 0 ? 17 : MOST_DIGITS;
    if (kind > 5 || digits > most || (kind === 0 && !digits) || exponent > 8 || (flags & 192) === 192) {
      throw record.fail("no number format");
    }
    return [kind, digits];
  });
  const places = record.runs(count, () => record.integer(known.length));
  return Uint8Array.from(places.flatMap((place) => (place ? known[place - 1] : [4, 0])));
}
