// What test_npm.py has the TypeScript compiler check: a program that uses all of the package.
import { open, MczError, type Clip, type Pose } from "mocapress";
import { bonesOf } from "mocapress/three";
import { Scene } from "three";

export async function play(contents: ArrayBuffer): Promise<number> {
  const clip: Clip = await open(contents, { read: async () => new Uint8Array(0) });
  clip.frameTime ??= 1 / 120;
  clip.seek(0.5);
  const pose: Pose = clip.pose(0.5, { space: "local", into: clip.makePose() });
  const { group, bones, show } = bonesOf(clip, { unit: clip.unit ?? 1 });
  new Scene().add(group);
  show(1);
  const names: string[] = clip.joints.map(({ name, parent }) => `${name} ${parent}`);
  // @ts-expect-error there is no such space
  clip.pose(0, { space: "sideways" });
  // @ts-expect-error the number of frames is the file's
  clip.frames = 3;
  return pose.positions[0]! + bones.length + names.length + clip.values(0).length;
}

export const isOurs = (error: unknown): boolean => error instanceof MczError;
