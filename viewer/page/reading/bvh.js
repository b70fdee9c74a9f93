import { FileError, quoted } from "./file_error.js";
import { decodedName, words as wordsOf } from "./names.js";
import { Rows } from "./rows.js";
import { latin1, Scanner } from "./scanner.js";
import { channelNames } from "./skeleton.js";

const KINDS = {
  xposition: "tx",
  yposition: "ty",
  zposition: "tz",
  xrotation: "rx",
  yrotation: "ry",
  zrotation: "rz",
};
// Around a name; bytes of UTF-8 may look like other blanks.
const BLANKS = /^[ \t\r\n\v\f]+|[ \t\r\n\v\f]+$/g;
const MOST_JOINTS = 2 ** 16;

/**
 * Read a BVH file.
 *
 * @param {Uint8Array} bytes
 * @returns {import("./clip.js").Clip}
 * @throws {FileError} where it does not follow the format
 */
export function parseBvh(bytes) {
  const { joints, frames, frameTime, rowsBegin } = new Hierarchy(latin1(bytes)).read();
  const columns = joints.flatMap((joint, index) => joint.channels.map((kind) => [index, kind]));
  if (!columns.length) throw new FileError("no channels", { expected: "a joint with CHANNELS" });
  const { rows, notes } = readRows(new Scanner(bytes, rowsBegin), columns.length, frames);
  const skeleton = { rotation: "moving", angleUnit: "deg", lengthUnit: null, joints, columns };
  return {
    names: channelNames(skeleton),
    frames: rows.count,
    channels: rows.channels(),
    skeleton,
    frameTime,
    notes,
  };
}

/** Every row; fewer than declared are an error, more are read, and the page says so. */
function readRows(scanner, columns, frames) {
  const rows = new Rows(columns);
  const notes = [];
  let extra = 0; // line of the first row that was not declared
  while (scanner.toContent()) {
    const begin = scanner.position;
    const first = rows.begin();
    let column = 0;
    for (let value; column < columns; column++) {
      value = scanner.number();
      if (Number.isNaN(value)) break;
      rows.values[first + column] = value;
    }
    if (column < columns || !scanner.lineEnds()) {
      const error = rowError(scanner, rows.count, `${columns} numbers on a line`);
      scanner.position = begin;
      const more = rows.count - 1 > frames && scanner.startsNumber();
      if (!scanner.onlyPadding() && (rows.count - 1 < frames || more)) throw error;
      rows.count--;
      notes.push(scanner.afterEnd());
      break;
    }
    if (rows.count === frames + 1) {
      scanner.position = begin;
      extra = scanner.line;
      scanner.toNextLine();
    }
  }
  const found = String(rows.count);
  if (rows.count < frames) {
    throw new FileError("frames are missing", { expected: `${frames} frames, as declared`, found });
  }
  if (extra) {
    const expected = `${frames} frames`;
    const note = new FileError("more frames than declared", { line: extra, expected, found });
    notes.unshift(note.message);
  }
  return { rows, notes };
}

function rowError(scanner, frame, expected) {
  return new FileError(`frame ${Math.max(1, frame)} cannot be read`, {
    line: scanner.line,
    expected,
    found: scanner.found,
  });
}

/** Reads what stands before the rows; braces may stand on a line of their own or not. */
class Hierarchy {
  constructor(text) {
    this.text = text;
    this.joints = [];
    this.stack = [];
  }

  read() {
    const piece = /[{}]|[^\s{}][^\n{}]*/g;
    let waiting = null; // a joint whose brace is to come
    for (let match = piece.exec(this.text); match; match = piece.exec(this.text)) {
      const at = match.index;
      const text = match[0].replace(/^\xef\xbb\xbf/, "");
      if (/^(#|\/\/|\s*$)/.test(text)) {
        piece.lastIndex = (this.text.indexOf("\n", at) + 1 || this.text.length + 1) - 1;
        continue;
      }
      const words = wordsOf(text);
      const key = words[0].toUpperCase();
      if (waiting && key !== "{") this.fail(at, `joint ${waiting.name}`, "{");
      if (key === "MOTION") {
        if (this.stack.length || !this.joints.length) {
          const expected = this.stack.length ? "}" : "ROOT";
          this.fail(at, "the hierarchy is not complete", expected);
        }
        return this.motion(piece.lastIndex);
      }
      if (key === "{") {
        if (!waiting) this.fail(at, "a brace without a joint", "ROOT, JOINT or End Site");
        this.stack.push(waiting);
        waiting = null;
      } else if (key === "ROOT" || key === "JOINT" || key === "END") {
        waiting = this.begin(at, key, decodedName(text.slice(key.length).replace(BLANKS, "")));
      } else {
        this.moreWords(piece, key, words);
        this.inside(at, key, words.slice(1));
      }
    }
    return this.fail(this.text.length, "no motion", "MOTION");
  }

  /** Take the words of the next lines, where OFFSET or CHANNELS go on there. */
  moreWords(piece, key, words) {
    const needed = { OFFSET: 4, CHANNELS: Math.min(Number(words[1]), 99) + 2 }[key] ?? 0;
    while (words.length < needed) {
      const begin = piece.lastIndex;
      const next = piece.exec(this.text);
      if (!next || next[0] === "{" || next[0] === "}") {
        piece.lastIndex = begin;
        return;
      }
      words.push(...wordsOf(next[0]));
    }
  }

  inside(at, key, words) {
    if (key === "}") this.close(at);
    else if (key === "OFFSET") this.offset(at, words);
    else if (key === "CHANNELS") this.channels(at, words);
    else if (key !== "HIERARCHY") {
      this.fail(at, "hierarchy", "ROOT, JOINT, End Site, OFFSET, CHANNELS or a brace");
    }
  }

  begin(at, key, name) {
    const above = this.stack.at(-1);
    if ((key === "ROOT") === Boolean(above) || above?.isEnd) {
      this.fail(at, `${key} in the wrong place`, "ROOT outside, JOINT inside of a joint");
    }
    if (key === "END") return { name, isEnd: true, offset: [0, 0, 0], above };
    if (this.joints.length >= MOST_JOINTS) {
      this.fail(at, "too many joints", `at most ${MOST_JOINTS}`);
    }
    const index = this.joints.length;
    this.joints.push({
      name,
      parent: above ? above.index : -1,
      offset: [0, 0, 0],
      channels: [],
      axis: [0, 0, 0],
      axisOrder: "xyz",
      ends: [],
    });
    return { name, isEnd: false, index };
  }

  offset(at, words) {
    const here = this.stack.at(-1);
    const vector = words.map(Number);
    if (!here || vector.length !== 3 || !vector.every(Number.isFinite)) {
      this.fail(at, "offset", "OFFSET and three numbers, inside of a joint");
    }
    if (here.isEnd) here.offset = vector;
    else this.joints[here.index].offset = vector;
  }

  channels(at, words) {
    const names = words.slice(1).map((word) => word.toLowerCase());
    const known = names.every((name) => Object.hasOwn(KINDS, name));
    if (!/^\d+$/.test(words[0] ?? "") || Number(words[0]) !== names.length || !known) {
      this.fail(at, "channels", "their number, and as many names like Xrotation");
    }
    const here = this.stack.at(-1);
    if (!here || here.isEnd || new Set(names).size < names.length) {
      this.fail(at, "channels", "each at most once, inside of a joint");
    }
    this.joints[here.index].channels = names.map((name) => KINDS[name]);
  }

  close(at) {
    const closed = this.stack.pop();
    if (!closed) this.fail(at, "a brace too many", "MOTION");
    if (closed.isEnd) this.joints[closed.above.index].ends.push(closed.offset);
  }

  motion(begin) {
    const frames = /\s*frames\s*:\s*(\S+)[^\n]*(?:\n|$)/iy;
    frames.lastIndex = begin;
    const count = frames.exec(this.text);
    if (!count || !/^\d{1,12}$/.test(count[1])) {
      this.fail(begin, "number of frames", "Frames: and their number");
    }
    const time = /\s*frame\s*time\s*:\s*(\S+)[^\n]*(?:\n|$)/iy;
    time.lastIndex = frames.lastIndex;
    const seconds = time.exec(this.text);
    if (!seconds || !(Number(seconds[1]) >= 0) || !Number.isFinite(Number(seconds[1]))) {
      this.fail(frames.lastIndex, "frame time", "Frame Time: and seconds");
    }
    return {
      joints: this.joints,
      frames: Number(count[1]),
      frameTime: Number(seconds[1]),
      rowsBegin: time.lastIndex,
    };
  }

  fail(at, what, expected) {
    const line = this.text.slice(0, at).split("\n").length;
    const rest = this.text.slice(at, at + 200);
    const found = rest.trim() ? quoted(rest.trimStart()) : "the end of the file";
    throw new FileError(what, { line, expected, found });
  }
}
