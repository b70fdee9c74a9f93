import type { Bone, Group } from "three";
import type { Clip } from "mocapress";

export interface Bones {
  /** Holds the roots, scaled to metres. */
  readonly group: Group;
  /** Of the joints, then of the ends of bones. */
  readonly bones: Bone[];
  /** Moves the bones to the pose at a time. */
  show(seconds: number): void;
}

/**
 * Makes bones of a clip's joints, for a `SkinnedMesh`, a `SkeletonHelper` or anything that hangs on
 * them.
 *
 * @param options `unit`: centimetres in a unit of the clip, by default what the file says, else 100
 */
export function bonesOf(clip: Clip, options?: { unit?: number }): Bones;
