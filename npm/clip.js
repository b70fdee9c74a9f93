import { MczError } from "./mcz/error.js";
import { rigOf } from "./mcz/rig.js";

const CENTIMETRES_PER_INCH = 2.54;
const KEPT = 2; // chunks
const NEAR = 0.9999; // a cosine within which unequal speeds are off by less than 1e-7 radians

/** A clip that is played; index.d.ts describes it. */
export class Clip {
  #stream;
  #chunks;
  #decode;
  #kinematics;
  #ends;
  #blocks = []; // decoded chunks, the latest first
  #pose;

  constructor(stream, skeleton, chunks, decode, kinematics) {
    this.#stream = stream;
    this.#chunks = chunks;
    this.#decode = decode;
    this.#kinematics = kinematics;
    this.frames = chunks.reduce((sum, chunk) => sum + chunk.frames, 0);
    this.frameTime = stream.frameTime;
    this.channels = stream.columns.map(({ name, joint, kind, unit }) => ({ name, joint, kind, unit }));
    const joints = skeleton?.joints ?? [];
    this.joints = joints.map(({ name, parent, offset }) => ({ name, parent, offset }));
    this.#ends = joints.flatMap(({ ends }, joint) => ends.map((place) => ({ joint, place })));
    this.parents = [...joints.map(({ parent }) => parent), ...this.#ends.map(({ joint }) => joint)];
    const unit = skeleton?.lengthUnit;
    this.unit = unit > 0 && unit !== 1 ? CENTIMETRES_PER_INCH / unit : null;
    this.#pose = this.makePose();
    if (kinematics) this.#tell(skeleton);
  }

  /** Say to the kinematics which skeleton the columns move. */
  #tell(skeleton) {
    const columns = this.#stream.columns.map(({ joint, kind }) => [joint, kind]);
    const turning = this.#stream.columns.find(({ kind }) => kind.startsWith("r"));
    const numbers = rigOf({ ...skeleton, columns }, turning?.unit || "deg");
    this.#write(numbers);
    this.#kinematics.exports.rig(numbers.length);
  }

  #write(numbers) {
    const { exports } = this.#kinematics;
    const place = exports.space(8 * numbers.length); // after which the memory may be another
    new Float64Array(exports.memory.buffer, place, numbers.length).set(numbers);
  }

  makePose() {
    return {
      positions: new Float64Array(3 * this.parents.length),
      rotations: new Float64Array(4 * this.joints.length),
    };
  }

  values(frame) {
    if (!Number.isInteger(frame) || frame < 0 || frame >= this.frames) {
      throw new RangeError(`no frame ${frame} of ${this.frames}`);
    }
    const { values, first } = this.#blockOf(frame);
    const columns = this.channels.length;
    return values.slice((frame - first) * columns, (frame - first + 1) * columns);
  }

  seek(seconds) {
    const { before, behind } = this.#between(seconds);
    this.#blockOf(before);
    this.#blockOf(behind);
  }

  pose(seconds, { space = "world", into = this.#pose } = {}) {
    if (!this.joints.length) throw new MczError("a clip without a skeleton has no poses");
    if (space !== "world" && space !== "local") throw new RangeError(`no space ${space}`);
    const { before, behind, part } = this.#between(seconds);
    const [a, b] = [this.#blockOf(before), this.#blockOf(behind)];
    const size = 7 * this.joints.length;
    const [at, to] = [(before - a.first) * size, (behind - b.first) * size];
    const { positions, rotations } = into;
    for (let j = 0; j < this.joints.length; j++) {
      for (let i = 3 * j; i < 3 * j + 3; i++) {
        positions[i] = a.locals[at + i] + (b.locals[to + i] - a.locals[at + i]) * part;
      }
      const turns = 3 * this.joints.length + 4 * j;
      turnBetween(a.locals, at + turns, b.locals, to + turns, part, rotations, 4 * j);
    }
    this.#ends.forEach(({ place }, i) => positions.set(place, 3 * (this.joints.length + i)));
    if (space === "world") this.#toWorld(into);
    return into;
  }

  #toWorld({ positions, rotations }) {
    const joints = this.joints.length;
    this.parents.forEach((parent, point) => {
      if (parent < 0) return;
      put(rotations, 4 * parent, positions, 3 * parent, 3 * point);
      if (point < joints) multiply(rotations, 4 * parent, 4 * point);
    });
  }

  #between(seconds) {
    if (!Number.isFinite(seconds)) throw new RangeError(`no time: ${seconds}`);
    if (!this.frames) throw new RangeError("a clip without frames");
    if (!(this.frameTime > 0)) throw new RangeError("the file does not state its rate: set clip.frameTime");
    const frame = Math.min(Math.max(seconds / this.frameTime, 0), this.frames - 1);
    const before = Math.floor(frame);
    const part = frame - before;
    return { before, behind: part > 0 ? Math.min(before + 1, this.frames - 1) : before, part };
  }

  /** The decoded chunk of a frame. */
  #blockOf(frame) {
    const has = ({ first, frames }) => frame >= first && frame < first + frames;
    const found = this.#blocks.findIndex(has);
    if (found === 0) return this.#blocks[0];
    const block = found > 0 ? this.#blocks.splice(found, 1)[0] : this.#load(this.#chunks.find(has));
    this.#blocks.unshift(block);
    this.#blocks.length = Math.min(this.#blocks.length, KEPT);
    return block;
  }

  #load(chunk) {
    const values = this.#decode(chunk);
    let locals = null;
    if (this.#kinematics) {
      this.#write(values);
      const { exports } = this.#kinematics;
      const place = exports.place_locally(chunk.frames, this.channels.length);
      if (!place) throw new MczError("bones that stretch (channel l) have no kinematics here");
      locals = new Float64Array(exports.memory.buffer, place, chunk.frames * 7 * this.joints.length).slice();
    }
    return { first: chunk.first, frames: chunk.frames, values, locals };
  }
}

/** At constant speed, the shorter way. */
function turnBetween(a, i, b, k, part, into, at) {
  const dot = a[i] * b[k] + a[i + 1] * b[k + 1] + a[i + 2] * b[k + 2] + a[i + 3] * b[k + 3];
  const cosine = Math.abs(dot);
  let [ofA, ofB] = [1 - part, part];
  if (part > 0 && cosine < NEAR) {
    const angle = Math.acos(cosine);
    ofA = Math.sin(ofA * angle) / Math.sin(angle);
    ofB = Math.sin(ofB * angle) / Math.sin(angle);
  }
  if (dot < 0) ofB = -ofB;
  let square = 0;
  for (let n = 0; n < 4; n++) {
    into[at + n] = part > 0 ? ofA * a[i + n] + ofB * b[k + n] : a[i + n];
    square += into[at + n] ** 2;
  }
  const scale = part > 0 ? 1 / Math.sqrt(square) : 1;
  for (let n = 0; n < 4; n++) into[at + n] *= scale;
}

/** Turn a place by what is above it, and move it there. */
function put(turns, t, places, origin, at) {
  const [w, a, b, c] = [turns[t], turns[t + 1], turns[t + 2], turns[t + 3]];
  const [px, py, pz] = [places[at], places[at + 1], places[at + 2]];
  const [x, y, z] = [2 * (b * pz - c * py), 2 * (c * px - a * pz), 2 * (a * py - b * px)];
  places[at] = places[origin] + px + w * x + b * z - c * y;
  places[at + 1] = places[origin + 1] + py + w * y + c * x - a * z;
  places[at + 2] = places[origin + 2] + pz + w * z + a * y - b * x;
}

/** Make a turn relative to what is above it one in space. */
function multiply(turns, above, own) {
  const [aw, ax, ay, az] = [turns[above], turns[above + 1], turns[above + 2], turns[above + 3]];
  const [bw, bx, by, bz] = [turns[own], turns[own + 1], turns[own + 2], turns[own + 3]];
  turns[own] = aw * bw - ax * bx - ay * by - az * bz;
  turns[own + 1] = aw * bx + ax * bw + ay * bz - az * by;
  turns[own + 2] = aw * by - ax * bz + ay * bw + az * bx;
  turns[own + 3] = aw * bz + ax * by - ay * bx + az * bw;
}
