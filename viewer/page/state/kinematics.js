import { FileError } from "../reading/file_error.js";

// Places of points that fit a browser's memory: three hours of a person at 120 frames a second.
const MOST_PLACES = 5e7;

/**
 * @typedef {import("../reading/clip.js").Clip & {
 *   parents: number[], positions: Float32Array}} PlacedClip
 * parents: of each point, joints before end sites, its parent's index, -1 for a root;
 * positions: (F, P, 3) in the file's units; both empty without a skeleton
 */

/**
 * Place the points of all frames.
 *
 * @param {import("../reading/clip.js").Clip} clip
 * @returns {PlacedClip}
 * @throws {FileError} when its skeleton cannot be placed, or has too many points
 */
export function placed(clip) {
  if (!clip.skeleton) return { ...clip, parents: [], positions: new Float32Array(0) };
  const kinematics = new Kinematics(clip);
  const { parents } = kinematics;
  if (clip.frames * parents.length > MOST_PLACES) {
    throw new FileError("too many frames and joints to be shown", {
      file: clip.name,
      expected: `a product of at most ${MOST_PLACES}`,
      found: `${clip.frames} x ${parents.length}`,
    });
  }
  return { ...clip, parents, positions: kinematics.positions() };
}

/**
 * Forward kinematics of one clip, by the conventions of docs/decisions/002-kinematics.md: a joint
 * turns by the product of its channels' turns, about axes already turned (BVH), or about the fixed
 * axes of its own frame (ASF); translations replace the offset (BVH) or add to it (ASF).
 */
export class Kinematics {
  /**
   * @param {import("../reading/clip.js").Clip} clip with a skeleton
   * @throws {FileError} when bones stretch (ASF `l`)
   */
  constructor(clip) {
    const { skeleton } = clip;
    this.frames = clip.frames;
    this.jointCount = skeleton.joints.length;
    /** Of each point, joints before end sites: its parent's index, -1 for a root. */
    this.parents = skeleton.joints.map((joint) => joint.parent);
    this.ends = [];
    skeleton.joints.forEach((joint, index) => {
      for (const end of joint.ends) {
        this.ends.push(end);
        this.parents.push(index);
      }
    });
    this.joints = movements(clip);
    this.turns = new Float64Array(4 * this.jointCount);
  }

  get points() {
    return this.parents.length;
  }

  /**
   * Place the joints and then the ends of one frame.
   *
   * @param {number} frame
   * @param {Float32Array|Float64Array} out takes 3 numbers per point, in the file's units
   * @param {number} [at] where in `out`
   */
  place(frame, out, at = 0) {
    const { turns, parents } = this;
    for (let j = 0; j < this.jointCount; j++) {
      const joint = this.joints[j];
      const x = along(joint, 0, frame);
      const y = along(joint, 1, frame);
      const z = along(joint, 2, frame);
      const parent = parents[j];
      if (parent < 0) {
        out[at + 3 * j] = x;
        out[at + 3 * j + 1] = y;
        out[at + 3 * j + 2] = z;
        set(turns, 4 * j, 1, 0, 0, 0);
      } else {
        placeFrom(turns, 4 * parent, out, at + 3 * parent, x, y, z, at + 3 * j);
        for (let k = 0; k < 4; k++) turns[4 * j + k] = turns[4 * parent + k];
      }
      this.#turn(joint, frame, 4 * j);
    }
    this.ends.forEach((end, k) => {
      const point = this.jointCount + k;
      const parent = parents[point];
      const to = at + 3 * point;
      placeFrom(turns, 4 * parent, out, at + 3 * parent, end[0], end[1], end[2], to);
    });
  }

  /** All frames' points: (F, P, 3), rounded to float32. */
  positions() {
    const all = new Float32Array(this.frames * this.points * 3);
    const one = new Float64Array(this.points * 3);
    for (let frame = 0; frame < this.frames; frame++) {
      this.place(frame, one);
      all.set(one, frame * one.length);
    }
    return all;
  }

  #turn(joint, frame, q) {
    const { turns } = this;
    if (joint.frame) multiply(turns, q, joint.frame);
    for (let k = 0; k < joint.turns.length; k++) {
      const { axis, angles, unit } = joint.turns[k];
      const half = (angles[frame] * unit) / 2;
      turnAbout(turns, q, axis, Math.cos(half), Math.sin(half));
    }
    if (joint.unframe) multiply(turns, q, joint.unframe);
  }
}

/** A coordinate of a joint's place in its parent's frame. */
function along(joint, axis, frame) {
  const channel = joint.moves[axis];
  if (!channel) return joint.offset[axis];
  return joint.adds ? channel[frame] + joint.offset[axis] : channel[frame];
}

/** What of each joint moves: its channels' values, found once. */
function movements(clip) {
  const { skeleton, channels } = clip;
  const byKind = skeleton.joints.map(() => new Map());
  skeleton.columns.forEach(([joint, kind], column) => byKind[joint]?.set(kind, channels[column]));
  const radians = (unit) => (unit === "rad" ? 1 : Math.PI / 180);
  const unit = radians(clip.angleUnit ?? skeleton.angleUnit);
  return skeleton.joints.map((joint, index) => {
    const own = byKind[index];
    if (own.get("l")?.some((value) => value !== 0)) {
      throw new FileError("bones that stretch (channel l) have no kinematics here");
    }
    const turns = joint.channels
      .filter((kind) => kind[0] === "r" && own.has(kind))
      .map((kind) => ({ axis: "xyz".indexOf(kind[1]), angles: own.get(kind), unit }));
    const fixed = skeleton.rotation === "fixed";
    if (fixed) {
      const rank = (turn) => joint.axisOrder.indexOf("xyz"[turn.axis]);
      turns.sort((a, b) => rank(b) - rank(a));
    }
    const moves = ["tx", "ty", "tz"].map((kind) =>
      joint.channels.includes(kind) ? own.get(kind) : undefined,
    );
    const made = { offset: joint.offset, moves, adds: fixed, turns };
    if (joint.axis.some((angle) => angle !== 0)) {
      made.frame = axisTurn(joint, radians(skeleton.angleUnit));
      made.unframe = made.frame.map((x, i) => (i ? -x : x));
    }
    return made;
  });
}

/** C: the rotation of an ASF bone's `axis`. */
function axisTurn(joint, unit) {
  const turn = new Float64Array([1, 0, 0, 0]);
  for (const name of [...joint.axisOrder].reverse()) {
    const axis = "xyz".indexOf(name);
    const half = (joint.axis[axis] * unit) / 2;
    turnAbout(turn, 0, axis, Math.cos(half), Math.sin(half));
  }
  return turn;
}

/** Multiply the quaternion at q (scalar first) by a turn about one axis, from the right. */
function turnAbout(turns, q, axis, c, s) {
  const w = turns[q];
  const x = turns[q + 1];
  const y = turns[q + 2];
  const z = turns[q + 3];
  if (axis === 0) set(turns, q, w * c - x * s, x * c + w * s, y * c + z * s, z * c - y * s);
  else if (axis === 1) set(turns, q, w * c - y * s, x * c - z * s, y * c + w * s, z * c + x * s);
  else set(turns, q, w * c - z * s, x * c + y * s, y * c - x * s, z * c + w * s);
}

function multiply(turns, q, b) {
  const bw = b[0];
  const bx = b[1];
  const by = b[2];
  const bz = b[3];
  const w = turns[q];
  const x = turns[q + 1];
  const y = turns[q + 2];
  const z = turns[q + 3];
  set(
    turns,
    q,
    w * bw - x * bx - y * by - z * bz,
    w * bx + x * bw + y * bz - z * by,
    w * by - x * bz + y * bw + z * bx,
    w * bz + x * by - y * bx + z * bw,
  );
}

function set(turns, q, w, x, y, z) {
  turns[q] = w;
  turns[q + 1] = x;
  turns[q + 2] = y;
  turns[q + 3] = z;
}

/** out[to] = out[from] + vector turned by the quaternion at q. */
function placeFrom(turns, q, out, from, x, y, z, to) {
  const w = turns[q];
  const a = turns[q + 1];
  const b = turns[q + 2];
  const c = turns[q + 3];
  const u = 2 * (b * z - c * y);
  const v = 2 * (c * x - a * z);
  const t = 2 * (a * y - b * x);
  out[to] = out[from] + x + w * u + b * t - c * v;
  out[to + 1] = out[from + 1] + y + w * v + c * u - a * t;
  out[to + 2] = out[from + 2] + z + w * t + a * v - b * u;
}
