import { FileError, quoted } from "./file_error.js";
import { grouped } from "./grouped.js";
import { decodedName, words as wordsOf } from "./names.js";

const CHANNELS = ["tx", "ty", "tz", "rx", "ry", "rz", "l"];

/**
 * Read an ASF file.
 *
 * @param {string} text
 * @returns {import("./skeleton.js").Skeleton} without columns: these are the AMC's
 * @throws {FileError} where it does not follow the format
 */
export function parseAsf(text) {
  const lines = [];
  text.split("\n").forEach((raw, index) => {
    const words = wordsOf(raw.split("#", 1)[0]);
    if (words[0]) lines.push({ number: index + 1, key: words[0].toLowerCase(), words });
  });
  return new Parser(lines).skeleton();
}

class Parser {
  constructor(lines) {
    this.lines = lines;
    this.next = 0;
  }

  skeleton() {
    const units = new Map();
    const bones = [];
    const children = [];
    let section = "";
    while (this.next < this.lines.length) {
      const line = this.lines[this.next++];
      if (line.key.startsWith(":")) {
        section = line.key;
        if (section === ":root") bones.unshift(newBone("root", line.number));
      } else if (section === ":units" && line.words.length > 1) {
        units.set(line.key, line.words[1]);
      } else if (section === ":root") {
        this.rootLine(bones[0], line);
      } else if (section === ":bonedata" && line.key === "begin") {
        bones.push(this.bone(line.number));
      } else if (section === ":hierarchy" && line.key !== "begin" && line.key !== "end") {
        children.push(line);
      }
    }
    if (bones[0]?.name !== "root") this.fail(1, "no root", "a section :root");
    this.link(bones, children);
    const named = this.lines.find((line) => line.key === "mocapress-root");
    bones[0].name = named?.words[1] ?? "root";
    const angleUnit = (units.get("angle") ?? "deg").toLowerCase();
    if (angleUnit !== "deg" && angleUnit !== "rad") {
      this.fail(1, "unit of angles", "deg or rad", quoted(angleUnit));
    }
    const length = units.get("length");
    const lengthUnit = length === undefined ? null : Number(length);
    if (Number.isNaN(lengthUnit)) this.fail(1, "unit of length", "a number", quoted(length));
    return { rotation: "fixed", angleUnit, lengthUnit, joints: joints(bones) };
  }

  rootLine(root, line) {
    if (line.key === "order") root.channels = this.channels(line);
    else if (line.key === "axis" && line.words[1])
      root.axisOrder = this.order(line, line.words.at(-1));
    else if (line.key === "position") root.position = this.vector(line);
    else if (line.key === "orientation") root.axis = this.vector(line);
  }

  bone(begin) {
    const bone = newBone("", begin);
    let direction = [0, 0, 0];
    let length = 0;
    for (;;) {
      const line = this.lines[this.next++];
      if (!line) this.fail(begin, "a bone without end", "end", "the end of the file");
      if (line.key === "end") break;
      if (line.key.startsWith(":")) this.fail(line.number, "a bone without end", "end", line.key);
      if (line.key === "name") bone.name = line.words.slice(1).join(" ");
      else if (line.key === "direction") direction = this.vector(line);
      else if (line.key === "length") length = this.number(line, line.words[1] ?? "");
      else if (line.key === "dof") bone.channels = this.channels(line);
      else if (line.key === "axis") {
        bone.axis = this.vector(line);
        bone.axisOrder = this.order(line, line.words[4] ?? "xyz");
      }
    }
    if (!bone.name) this.fail(begin, "a bone without a name", "name");
    // Only the direction of `direction` counts: files exist where it is not of unit length.
    const scale = length / (Math.hypot(...direction) || 1);
    bone.vector = direction.map((x) => x * scale);
    return bone;
  }

  /** Set parents. Where names repeat, each mention as a child means the next such bone. */
  link(bones, lines) {
    const exact = grouped(bones, (bone) => bone.name);
    const folded = grouped(bones, (bone) => bone.name.toLowerCase());
    const find = (line, name) =>
      exact.get(name) ??
      folded.get(name.toLowerCase()) ??
      this.fail(line.number, "hierarchy", "the name of a bone", quoted(name));
    const linked = new Set([0]);
    for (const line of lines) {
      const parents = find(line, line.words[0]);
      const parent = parents.findLast((i) => linked.has(i)) ?? parents[0];
      for (const word of line.words.slice(1)) {
        const child = find(line, word).find((i) => !linked.has(i));
        if (child === undefined) {
          this.fail(line.number, "hierarchy", "a bone without a parent", quoted(word));
        }
        bones[child].parent = parent;
        linked.add(child);
      }
    }
    const reached = new Set(depthFirst(bones));
    const loose = bones.find((_, i) => !reached.has(i));
    if (loose) this.fail(loose.line, `bone ${loose.name}`, "a way to root in :hierarchy");
  }

  channels(line) {
    const channels = line.words.slice(1).map((word) => word.toLowerCase());
    const known = channels.every((channel) => CHANNELS.includes(channel));
    if (!known || new Set(channels).size < channels.length) {
      this.fail(line.number, line.key, "each of tx ty tz rx ry rz l at most once", text(line));
    }
    return channels;
  }

  order(line, word) {
    if ([...word.toLowerCase()].sort().join("") !== "xyz") {
      this.fail(line.number, "order of axes", "x, y and z in some order", quoted(word));
    }
    return word.toLowerCase();
  }

  vector(line) {
    if (line.words.length < 4) this.fail(line.number, line.key, "three numbers", text(line));
    return line.words.slice(1, 4).map((word) => this.number(line, word));
  }

  number(line, word) {
    const value = word === "" ? NaN : Number(word);
    if (!Number.isFinite(value)) this.fail(line.number, line.key, "a number", quoted(word));
    return value;
  }

  fail(line, what, expected, found) {
    throw new FileError(what, { line, expected, found });
  }
}

function newBone(name, line) {
  return {
    name,
    line,
    parent: -1,
    vector: [0, 0, 0],
    axis: [0, 0, 0],
    axisOrder: "xyz",
    channels: [],
    position: [0, 0, 0],
  };
}

function text(line) {
  return line.words.join(" ");
}

function depthFirst(bones) {
  const below = grouped(bones, (bone) => bone.parent);
  const order = [];
  const stack = [0];
  while (stack.length) {
    const i = stack.pop();
    order.push(i);
    stack.push(...(below.get(i) ?? []).filter((child) => child !== 0).reverse());
  }
  return order;
}

/** A bone is the joint at its start; parents stand before children, else the file's order stays. */
function joints(bones) {
  const inOrder = bones.every((bone, i) => bone.parent < i);
  const order = inOrder ? [...bones.keys()] : depthFirst(bones);
  const place = new Map(order.map((i, k) => [i, k]));
  const isParent = new Set(bones.slice(1).map((bone) => bone.parent));
  return order.map((i) => {
    const bone = bones[i];
    return {
      name: decodedName(bone.name),
      parent: i === 0 ? -1 : place.get(bone.parent),
      offset: i === 0 ? bone.position : bones[bone.parent].vector,
      channels: bone.channels,
      axis: bone.axis,
      axisOrder: bone.axisOrder,
      ends: i === 0 || isParent.has(i) ? [] : [bone.vector],
    };
  });
}
