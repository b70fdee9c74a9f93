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
    this.jointNames = clip.skeleton ? clip.skeleton.joints.map((joint) => joint.name) : [];
    this.standAs(findBearings(this.positions, this.points, this.jointNames));
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
    this.bearings = bearings;
    const { up, scale, floor } = bearings;
    const turn = turnUp(up);
    const [a, b, c] = [turn(1, 0, 0), turn(0, 1, 0), turn(0, 0, 1)];
    /** Rows of the matrix that leads from the file's space to the stage's, y up. */
    this.rows = [0, 1, 2].map((i) => [a[i] * scale, b[i] * scale, c[i] * scale]);
    this.shift = [0, -floor * scale, 0];
    this.way = smoothed(this);
  }

  /** Stand with another axis up. */
  standUp(up) {
    this.standAs(findBearings(this.positions, this.points, this.jointNames, up));
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

  /** Where a camera that follows should look, on the floor: [x, z]. */
  wayAt(frame) {
    return this.points ? [this.way[2 * frame], this.way[2 * frame + 1]] : [0, 0];
  }
}

/** The root's way over the floor without its steps: (F, 2). */
function smoothed(take) {
  const { frames } = take;
  const way = new Float32Array(2 * frames);
  if (!take.points) return way;
  const sums = new Float64Array(2 * (frames + 1));
  const here = [0, 0, 0];
  for (let frame = 0; frame < frames; frame++) {
    take.onStage(frame, 0, here);
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
