// Reads the parts of a DiffMA document and checks them. Only own properties of the known names are
// looked at, and copied; nothing recurses into what a document nests.

const MOST_BITS = 12;
const MOST_ORDER = 7;
const MOST_WINDOW = 2 ** 20;
const CLASSES = ["DiffMA", "DiffMAx"];
const KINDS = ["tx", "ty", "tz", "rx", "ry", "rz", "l"];
const AXIS_ORDERS = ["xyz", "xzy", "yxz", "yzx", "zxy", "zyx"];

/** A document that breaks the format: where (`path`, a JSON path), what was expected, what found. */
export class DiffmaError extends Error {
  constructor(path, expected, found) {
    super(`${path}: expected ${expected}; found ${found}`);
    this.name = "DiffmaError";
    this.path = path;
    this.expected = expected;
    this.found = found;
  }
}

export function readDocument(source, bound) {
  const root = object(typeof source === "string" ? parse(source) : source, "$");
  const names = arrayOf(string, own(root, "channels"), "$.channels");
  const document = {
    names,
    params: readParams(object(own(root, "params"), "$.params"), names.length),
    frameTime: optional(bounded(number, 0, Infinity), own(root, "frameTime"), "$.frameTime"),
    layout: optional(string, own(root, "layout"), "$.layout"),
    skeleton: optional(readSkeleton(names.length), own(root, "skeleton"), "$.skeleton"),
  };
  const level = readLevel(own(root, "levels"), bound, names.length);
  if (level) {
    document.params = { ...document.params, bound: level.bound, order: 0 };
    return { ...document, records: level.records, place: level.place };
  }
  const records = readRecords(own(root, "records"), "$.records", names.length);
  return { ...document, records, place: "$.records" };
}

function parse(text) {
  try {
    return JSON.parse(text);
  } catch (error) {
    throw new DiffmaError("$", "JSON", error.message);
  }
}

function readParams(params, channels) {
  const positive = bounded(number, Number.MIN_VALUE, Number.MAX_VALUE);
  const at = (key) => own(params, key);
  const bits = bounded(integer, 1, MOST_BITS)(at("bits"), "$.params.bits");
  const encoding = optional(string, at("encoding"), "$.params.encoding") ?? "base85";
  const known = bits > 6 ? "base85x2" : "base85";
  if (encoding !== known) {
    const expected = `"${known}" with ${bits} bits`;
    throw new DiffmaError("$.params.encoding", expected, describe(encoding));
  }
  const kind = optional(string, at("class"), "$.params.class") ?? "DiffMA";
  if (!CLASSES.includes(kind)) {
    throw new DiffmaError("$.params.class", '"DiffMA" or "DiffMAx"', describe(kind));
  }
  const order = bounded(integer, 0, MOST_ORDER);
  return {
    class: kind,
    bits,
    window: bounded(integer, 1, MOST_WINDOW)(at("window"), "$.params.window"),
    bound: perChannel(positive, at("bound"), "$.params.bound", channels),
    order: perChannel(order, at("order") ?? 0, "$.params.order", channels),
    // `null`: no limit.
    tolerance: at("tolerance") === null ? null : optional(positive, at("tolerance"), "$.params.tolerance"),
    roundOffset: optional(bounded(number, 0, 1), at("roundOffset"), "$.params.roundOffset"),
    encoding,
  };
}

function perChannel(read, value, path, channels) {
  return Array.isArray(value) ? arrayOf(read, value, path, channels) : read(value, path);
}

function readRecords(value, place, channels) {
  const records = object(value, place);
  return {
    b: arrayOf(string, own(records, "b"), `${place}.b`, channels),
    t: arrayOf((t, path) => arrayOf(number, t, path), own(records, "t"), `${place}.t`, channels),
  };
}

// Of the levels of detail, the coarsest that is not coarser than asked.
function readLevel(value, bound, channels) {
  if (value === undefined || bound === undefined) return undefined;
  const positive = bounded(number, Number.MIN_VALUE, Number.MAX_VALUE);
  const levels = arrayOf(object, value, "$.levels").map((level, i) => ({
    bound: positive(own(level, "bound"), `$.levels[${i}].bound`),
    records: own(level, "records"),
    place: `$.levels[${i}].records`,
  }));
  const fitting = levels.filter((level) => level.bound <= bound).sort((a, b) => b.bound - a.bound);
  if (fitting.length === 0) return undefined;
  const { records, place } = fitting[0];
  return { ...fitting[0], records: readRecords(records, place, channels) };
}

// Reads the optional skeleton of a document: enough for forward kinematics.



function readSkeleton(channels) {
  return (value, path) => {
    const skeleton = object(value, path);
    const at = (key) => own(skeleton, key);
    const list = arrayOf((joint) => joint, at("joints"), `${path}.joints`);
    const joints = list.map((joint, i) => readJoint(joint, `${path}.joints[${i}]`, i));
    const length = at("lengthUnit") ?? null;
    const columns = arrayOf(readColumn(joints.length), at("columns"), `${path}.columns`, channels);
    return {
      rotation: choice(at("rotation"), `${path}.rotation`, ["moving", "fixed"]),
      angleUnit: choice(at("angleUnit") ?? "deg", `${path}.angleUnit`, ["deg", "rad"]),
      lengthUnit: length === null ? null : number(length, `${path}.lengthUnit`),
      joints,
      columns,
    };
  };
}

function readJoint(value, path, index) {
  const joint = object(value, path);
  const at = (key) => own(joint, key);
  const zero = [0, 0, 0];
  const kind = (text, place) => choice(text, place, KINDS);
  const ends = optional((v, p) => arrayOf(vector, v, p), at("ends"), `${path}.ends`);
  return {
    name: string(at("name"), `${path}.name`),
    // Parents stand before their children.
    parent: bounded(integer, -1, index - 1)(at("parent"), `${path}.parent`),
    offset: vector(at("offset"), `${path}.offset`),
    channels: arrayOf(kind, at("channels") ?? [], `${path}.channels`),
    axis: optional(vector, at("axis"), `${path}.axis`) ?? zero,
    axisOrder: choice(at("axisOrder") ?? "xyz", `${path}.axisOrder`, AXIS_ORDERS),
    ends: ends ?? [],
  };
}

// A channel's column: its joint (-1: none) and its kind.
function readColumn(joints) {
  return (value, path) => {
    const pair = arrayOf((item) => item, value, path, 2);
    const joint = bounded(integer, -1, joints - 1)(pair[0], `${path}[0]`);
    return [joint, string(pair[1], `${path}[1]`)];
  };
}

function vector(value, path) {
  return arrayOf(number, value, path, 3);
}

function choice(value, path, known) {
  if (!known.includes(value)) {
    throw new DiffmaError(path, known.map((word) => `"${word}"`).join(" or "), describe(value));
  }
  return value;
}

// Reading values of JSON: each gives the value, or throws what was expected and found at which path.


function own(value, key) {
  return Object.hasOwn(value, key) ? value[key] : undefined;
}

function optional(read, value, path) {
  return value === undefined ? undefined : read(value, path);
}

function object(value, path) {
  if (typeof value !== "object" || value === null || Array.isArray(value)) {
    throw new DiffmaError(path, "an object", describe(value));
  }
  return value;
}

function string(value, path) {
  if (typeof value !== "string") throw new DiffmaError(path, "a string", describe(value));
  return value;
}

function number(value, path) {
  if (typeof value !== "number" || !Number.isFinite(value)) {
    throw new DiffmaError(path, "a finite number", describe(value));
  }
  return value;
}

function integer(value, path) {
  if (!Number.isSafeInteger(value)) throw new DiffmaError(path, "an integer", describe(value));
  return value;
}

function bounded(read, least, most) {
  return (value, path) => {
    const found = read(value, path);
    if (found < least || found > most) {
      throw new DiffmaError(path, `${least} to ${most}`, describe(found));
    }
    return found;
  };
}

function arrayOf(read, value, path, length) {
  if (!Array.isArray(value)) throw new DiffmaError(path, "an array", describe(value));
  if (length !== undefined && value.length !== length) {
    throw new DiffmaError(path, `${length} items`, `${value.length}`);
  }
  const items = new Array(value.length);
  for (let i = 0; i < value.length; i++) {
    // The path is made only where it is needed: it would cost more than the check.
    if (typeof value[i] === "number" && read === number && Number.isFinite(value[i])) {
      items[i] = value[i];
    } else {
      items[i] = read(value[i], `${path}[${i}]`);
    }
  }
  return items;
}

/** A value as short text for a message. */
function describe(value) {
  if (value === undefined) return "nothing";
  if (Array.isArray(value)) return `an array of ${value.length}`;
  if (typeof value === "object" && value !== null) return "an object";
  const text = typeof value === "string" ? JSON.stringify(value) : String(value);
  return text.length > 40 ? `${text.slice(0, 40)}…` : text;
}
