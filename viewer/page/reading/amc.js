import { FileError, quoted } from "./file_error.js";
import { grouped } from "./grouped.js";
import { decodedName, words as wordsOf } from "./names.js";
import { Rows } from "./rows.js";
import { latin1, Scanner } from "./scanner.js";
import { channelNames } from "./skeleton.js";

// What programs leave behind a text: NULs, or the Ctrl-Z of DOS.
const PADDING = /^[\0\x1a]/;
const MOST_LATER_BONES = 256;
const ROOT_CHANNELS = ["tx", "ty", "tz", "rx", "ry", "rz"];

/**
 * Read an AMC file. A bone that a frame leaves out keeps its values of the frame before.
 *
 * @param {Uint8Array} bytes
 * @param {import("./skeleton.js").Skeleton|null} skeleton its ASF; null gives curves without figure
 * @returns {import("./clip.js").Clip}
 * @throws {FileError} where it does not follow the format, or the skeleton
 */
export function parseAmc(bytes, skeleton) {
  const text = latin1(bytes);
  const counter = /^[ \t]*-?\d+[ \t]*\r?$/m.exec(text);
  if (!counter) throw new FileError("no frame", { expected: "a line with a frame's number" });
  let bones = firstFrame(text, counter.index);
  let read;
  try {
    read = readFrames(new Scanner(bytes, counter.index), bones);
  } catch (error) {
    const all = withLaterBones(text, counter.index, bones);
    if (all.length === bones.length) throw error;
    bones = all;
    read = readFrames(new Scanner(bytes, counter.index), bones);
  }
  const { rows, notes } = read;
  const header = text.slice(0, counter.index);
  const unit = /^\s*:(radians|degrees)/im.exec(header)?.[1].toLowerCase();
  const rate = Number(/^[ \t]*:samples-per-second[ \t]+(\S+)/im.exec(header)?.[1]);
  const columns = skeleton ? columnsOf(skeleton, bones) : null;
  const made = columns && { ...skeleton, columns };
  return {
    names: made ? channelNames(made) : plainNames(bones),
    frames: rows.count,
    channels: rows.channels(),
    skeleton: made,
    frameTime: rate > 0 && rate < Infinity ? 1 / rate : null,
    angleUnit: unit === "radians" ? "rad" : unit === "degrees" ? "deg" : undefined,
    notes: made ? notes : ["no skeleton: drop the .asf together with the .amc", ...notes],
  };
}

/** Names and number of values of the bones, as the first frame has them. */
function firstFrame(text, begin) {
  const bones = [];
  let first = 0;
  for (const raw of linesFrom(text, text.indexOf("\n", begin) + 1 || text.length)) {
    const words = wordsOf(raw);
    if (/^-?\d+$/.test(raw.trim())) break;
    if (PADDING.test(raw) || !words[0] || words[0].startsWith("#")) continue;
    bones.push({ name: words[0], count: words.length - 1, first });
    first += words.length - 1;
  }
  if (!first) {
    const line = text.slice(0, begin).split("\n").length;
    const expected = "lines with a bone and its numbers";
    throw new FileError("the first frame cannot be read", { line, expected });
  }
  return bones;
}

/** All bones that any frame has, each behind the one that it follows there. */
function withLaterBones(text, begin, bones) {
  const all = [...bones];
  const known = new Set(bones.map((bone) => bone.name));
  let place = 0;
  for (const raw of linesFrom(text, begin)) {
    const [name, ...values] = wordsOf(raw);
    if (!name) continue;
    if (!values.length || /^[#\0\x1a]/.test(name)) place = 0;
    else if (known.has(name)) place = all.findIndex((bone) => bone.name === name) + 1;
    else if (known.size < bones.length + MOST_LATER_BONES) {
      all.splice(place++, 0, { name, count: values.length });
      known.add(name);
    }
  }
  let first = 0;
  return all.map(({ name, count }) => {
    first += count;
    return { name, count, first: first - count };
  });
}

function* linesFrom(text, begin) {
  for (let at = begin; at < text.length;) {
    const end = text.indexOf("\n", at);
    yield text.slice(at, end < 0 ? text.length : end);
    at = end < 0 ? text.length : end + 1;
  }
}

function readFrames(scanner, bones) {
  const last = bones.at(-1);
  const rows = new Rows(last.first + last.count);
  const byName = new Map(bones.map((bone, index) => [bone.name, index]));
  const repeated = byName.size < bones.length;
  const seen = new Int32Array(bones.length);
  const notes = [];
  const fail = (expected) => {
    const what = `frame ${Math.max(1, rows.count)} cannot be read`;
    throw new FileError(what, { line: scanner.line, expected, found: scanner.found });
  };
  let next = bones.length; // the bone that should come; a frame's number may come as well
  let first = 0;
  while (scanner.toContent()) {
    const begin = scanner.position;
    if (scanner.onlyPadding()) {
      notes.push(scanner.afterEnd());
      break;
    }
    if (next < bones.length && scanner.passes(bones[next].name)) {
      seen[next] = rows.count;
      readValues(scanner, rows.values, first, bones[next], fail);
      next++;
      continue;
    }
    const word = scanner.word();
    const index = byName.get(word);
    if (/^-?\d+$/.test(word) && scanner.lineEnds()) {
      if (repeated && rows.count && next < bones.length) {
        scanner.position = begin;
        fail(`bone ${bones[next].name}`);
      }
      first = rows.begin();
      next = 0;
    } else if (index === undefined || repeated || !rows.count || seen[index] === rows.count) {
      scanner.position = begin;
      fail(next < bones.length ? `bone ${bones[next].name}` : "the next frame's number");
    } else {
      seen[index] = rows.count;
      readValues(scanner, rows.values, first, bones[index], fail);
      next = index + 1;
    }
  }
  if (repeated && next < bones.length) fail(`bone ${bones[next].name}`);
  return { rows, notes };
}

function readValues(scanner, values, first, bone, fail) {
  const expected = `${bone.count} numbers for bone ${bone.name}`;
  for (let k = 0; k < bone.count; k++) {
    const value = scanner.number();
    if (Number.isNaN(value)) fail(expected);
    values[first + bone.first + k] = value;
  }
  if (!scanner.lineEnds()) fail(expected);
}

/**
 * Joint and kind of each column: by name, else by name without regard to case.
 *
 * @param {import("./skeleton.js").Skeleton} skeleton
 * @param {{name: string, count: number}[]} bones in the order of the columns
 */
export function columnsOf(skeleton, bones) {
  const { joints } = skeleton;
  // Bones without degrees of freedom usually have no values.
  const order = (group) => group.sort((a, b) => !joints[a].channels.length - !joints[b].channels.length);
  const exact = grouped(joints, (joint) => joint.name);
  const folded = grouped(joints, (joint) => joint.name.toLowerCase());
  for (const group of [...exact.values(), ...folded.values()]) order(group);
  const seen = new Map();
  return bones.flatMap(({ name: word, count }) => {
    const name = word.toLowerCase() === "root" ? joints[0].name : decodedName(word);
    const nth = seen.get(name) ?? 0;
    seen.set(name, nth + 1);
    const joint = (exact.get(name) ?? folded.get(name.toLowerCase()) ?? [])[nth];
    if (joint === undefined) {
      const some = joints.slice(0, 8).map((j) => j.name);
      throw new FileError(`the skeleton has no bone ${name}`, {
        expected: `${some.join(", ")}, …`,
        found: quoted(name),
      });
    }
    // Values of a bone without degrees of freedom are kept, and move nothing.
    const channels = joints[joint].channels.length ? joints[joint].channels : otherKinds(count);
    if (channels.length !== count) {
      throw new FileError(`values of bone ${name}`, {
        expected: `${channels.length} (${channels.join(" ")}), as the skeleton has`,
        found: String(count),
      });
    }
    return channels.map((kind) => [joint, kind]);
  });
}

function otherKinds(count) {
  return Array.from({ length: count }, (_, k) => `v${k + 1}`);
}

function plainNames(bones) {
  const seen = new Map();
  return bones.flatMap(({ name: word, count }, place) => {
    const name = decodedName(word);
    const nth = (seen.get(name) ?? 0) + 1;
    seen.set(name, nth);
    const label = nth === 1 ? name : `${name}#${nth}`;
    const kinds = place === 0 && count === 6 ? ROOT_CHANNELS : otherKinds(count);
    return kinds.map((kind) => `${label}.${kind}`);
  });
}
