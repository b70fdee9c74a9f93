import { findBearings, turnUp } from "./bearings.js";
import { secondsPerFrame } from "../reading/clip.js";
import { FileError } from "../reading/file_error.js";

const SMOOTHING = 0.6; // seconds over which the way that a camera follows is averaged

/** A clip made ready to be played: placed in space, upright, scaled, on the floor. */
export class Take {
  /**
   * @param {import("../work/placing.js").PlacedClip} clip
   * @throws {FileError} when it has no frames
   */
  constructor(clip) {
    if (clip.frames === 0) throw new FileError("no frames", { file: clip.name });
    this.clip = clip;
    this.name = clip.name ?? "clip";
    this.frames = clip.frames;
    this.frameTime = secondsPerFrame(clip);
    this.parents = clip.parents;
    this.points = this.parents.length;
    this.positions = clip.positions;
    const { skeleton, markers } = clip;
    this.jointNames = skeleton ? skeleton.joints.map((joint) => joint.name) : [];
    if (markers) this.jointNames = markers.labels.slice(0, markers.drawn);
    this.root = markers ? 0 : rootOf(this);
    /** Points that lead the way: the root, of markers those most seen. */
    this.leading = markers ? mostSeen(clip.gaps, this.points) : [this.root];
    /** Bones as pairs of points, of joints the parent first. */
    this.bones = markers?.bones ?? this.parents.map((parent, i) => [parent, i]);
    this.bones = this.bones.filter(([parent]) => parent >= this.root);
    this.standUp();
  }

  /** Whether a marker is missing in a frame. */
  isMissing(frame, point) {
    return Boolean(this.clip.gaps?.[frame * this.points + point]);
  }

  /** Whether it has not been seen yet, or will not be seen any more. */
  isGone(frame, point) {
    return this.clip.gaps?.[frame * this.points + point] === 2;
  }

  get seconds() {
    return this.frames * this.frameTime;
  }

  /** The frame at a time, the last one after the end. */
  frameAt(time) {
    return Math.min(this.frames - 1, Math.max(0, Math.floor(time / this.frameTime + 1e-6)));
  }

  /** Take other bearings: those of the original for what was decoded, or another up axis. */
  standAs(bearings) {
    if (this.bearings === bearings) return;
    this.bearings = bearings;
    const { up, scale, floor } = bearings;
    const turn = turnUp(up);
    const [a, b, c] = [turn(1, 0, 0), turn(0, 1, 0), turn(0, 0, 1)];
    /** Rows of the matrix that leads from the file's space to the stage's, y up. */
    this.rows = [0, 1, 2].map((i) => [a[i] * scale, b[i] * scale, c[i] * scale]);
    this.shift = [0, -floor * scale, 0];
    this.way = smoothed(this);
  }

  /** Stand with an axis up; without one, with that which seems to be. */
  standUp(up) {
    if (up || !this.own) {
      const { root, clip } = this;
      const known = { up, gaps: clip.gaps, root, rest: clip.skeleton && atRest(clip.skeleton) };
      const found = findBearings(this.positions, this.points, this.jointNames, known);
      if (up) return this.standAs(found);
      this.own = found;
    }
    this.standAs(this.own);
  }

  /** Place of a point on the stage, into `out`. */
  onStage(frame, point, out, at = 0) {
    const from = 3 * (frame * this.points + point);
    const [x, y, z] = [this.positions[from], this.positions[from + 1], this.positions[from + 2]];
    for (let i = 0; i < 3; i++) {
      const row = this.rows[i];
      out[at + i] = row[0] * x + row[1] * y + row[2] * z + this.shift[i];
    }
  }

  /** Place of the root on the stage, of markers the middle of those most seen, into `out`. */
  rootOnStage(frame, out) {
    const sum = [0, 0, 0];
    for (const point of this.leading) {
      this.onStage(frame, point, out);
      for (let i = 0; i < 3; i++) sum[i] += out[i];
    }
    for (let i = 0; i < 3; i++) out[i] = sum[i] / this.leading.length;
  }

  /** Where a camera that follows should look, on the floor: [x, z]. */
  wayAt(frame) {
    return this.points ? [this.way[2 * frame], this.way[2 * frame + 1]] : [0, 0];
  }
}

/**
 * The first joint that moves or branches: where others stand still above it, as some tools export the
 * scene's origin, they are no part of the figure.
 */
function rootOf({ positions, parents, points, frames }) {
  let root = 0;
  while (2 * root < points && isStill(root) && isOnlyChild(root + 1)) root++;
  return 2 * root < points ? root : 0; // a chain of links in a row is a figure, too

  function isStill(point) {
    const start = positions.subarray(3 * point, 3 * point + 3);
    for (let frame = 1; frame < frames; frame++) {
      const at = 3 * (frame * points + point);
      if (start.some((x, axis) => positions[at + axis] !== x)) return false;
    }
    return true;
  }

  function isOnlyChild(point) {
    const parent = point - 1;
    return parents[point] === parent && parents.lastIndexOf(parent) === point;
  }
}

/** Places of the joints where all channels are 0, but for the root's. */
function atRest({ joints }) {
  const places = new Float32Array(3 * joints.length);
  joints.forEach(({ parent, offset }, i) => {
    if (parent < 0) return;
    for (let k = 0; k < 3; k++) places[3 * i + k] = places[3 * parent + k] + offset[k];
  });
  return places;
}

/** A quarter of the markers, whose middle does not jump when others come and go. */
function mostSeen(gaps, points) {
  const missing = new Float64Array(points);
  gaps.forEach((gap, i) => (missing[i % points] += Number(gap > 0)));
  const all = [...missing.keys()].sort((a, b) => missing[a] - missing[b]);
  return all.slice(0, Math.ceil(points / 4));
}

/** The root's way over the floor without its steps: (F, 2). */
function smoothed(take) {
  const { frames } = take;
  const way = new Float32Array(2 * frames);
  if (!take.points) return way;
  const sums = new Float64Array(2 * (frames + 1));
  const here = [0, 0, 0];
  for (let frame = 0; frame < frames; frame++) {
    take.rootOnStage(frame, here);
    sums[2 * frame + 2] = sums[2 * frame] + here[0];
    sums[2 * frame + 3] = sums[2 * frame + 1] + here[2];
  }
  const half = Math.round(SMOOTHING / take.frameTime / 2);
  for (let frame = 0; frame < frames; frame++) {
    const begin = Math.max(0, frame - half);
    const end = Math.min(frames, frame + half + 1);
    for (let k = 0; k < 2; k++) {
      way[2 * frame + k] = (sums[2 * end + k] - sums[2 * begin + k]) / (end - begin);
    }
  }
  return way;
}
