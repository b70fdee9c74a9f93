/** What is wrong with a file: damaged, of a later version, or not for this package. */
export class MczError extends Error {}

export interface Joint {
  readonly name: string;
  /** Index of the parent, -1 for a root; smaller than the joint's own. */
  readonly parent: number;
  /** From the parent's joint, at rest, in the file's units. */
  readonly offset: readonly [number, number, number];
}

export interface Channel {
  /** E.g. `lfemur.rx`. */
  readonly name: string;
  /** Index of the joint; -1 for none. */
  readonly joint: number;
  /** `tx ty tz rx ry rz`, or another word. */
  readonly kind: string;
  /** `deg`, `rad`, `length` or empty. */
  readonly unit: string;
}

export interface Pose {
  /** x, y, z of each point: the joints, then the ends of bones without further joints. */
  readonly positions: Float64Array;
  /** w, x, y, z of each joint: unit quaternions, scalar first. */
  readonly rotations: Float64Array;
}

export interface Clip {
  readonly frames: number;
  /** Seconds a frame lasts; null where the file does not say: set it before asking for poses. */
  frameTime: number | null;
  /** Empty without a skeleton. */
  readonly joints: readonly Joint[];
  /** Of each point, the joint that it hangs on; -1 for roots. */
  readonly parents: readonly number[];
  readonly channels: readonly Channel[];
  /** Centimetres in a unit of length, where the file says it. */
  readonly unit: number | null;
  /**
   * The channels of a frame; of the codec `exact` those of the motion file, bit for bit.
   * @throws RangeError where there is no such frame
   */
  values(frame: number): Float64Array;
  /** Decodes what poses at a time need; the last two chunks are kept. */
  seek(seconds: number): void;
  /**
   * The pose at a time: outside the clip that of its nearer end, between two frames rotations at
   * constant speed the shorter way and lines between places.
   *
   * Without `into`, the pose is good until the next is asked for.
   *
   * @throws MczError where a chunk is damaged, or there is no skeleton
   * @throws RangeError where the time is none, or the rate is not known
   */
  pose(seconds: number, options?: { space?: "world" | "local"; into?: Pose }): Pose;
  /** Arrays for a pose. */
  makePose(): Pose;
}

export interface OpenOptions {
  /** Gives a file of the package's folder `files`, e.g. `wasm/near.wasm`; by default it is fetched. */
  read?: (path: string) => Uint8Array | Promise<Uint8Array>;
}

/**
 * Opens the contents of a `.mcz` file, coded by `exact` (without a model), `near`, `patterns` or
 * `qssd`. All checksums are checked; chunks are decoded when poses need them.
 *
 * @throws MczError where it is damaged, holds no motion, or needs what is not here
 */
export function open(contents: Uint8Array | ArrayBuffer, options?: OpenOptions): Promise<Clip>;
