// Clips as bones of three.js. three.d.ts describes what is here.
import { Bone, Group } from "three";

export function bonesOf(clip, { unit = clip.unit ?? 100 } = {}) {
  const group = new Group();
  const bones = clip.joints.map(({ name }) => Object.assign(new Bone(), { name }));
  clip.joints.forEach(({ parent }, j) => (parent < 0 ? group : bones[parent]).add(bones[j]));
  for (let p = clip.joints.length; p < clip.parents.length; p++) {
    bones.push(Object.assign(new Bone(), { name: `${clip.joints[clip.parents[p]].name}_end` }));
    bones[clip.parents[p]].add(bones[p]);
  }
  group.scale.setScalar(unit / 100);
  const pose = clip.makePose();
  return {
    group,
    bones,
    show(seconds) {
      const { positions, rotations } = clip.pose(seconds, { space: "local", into: pose });
      bones.forEach((bone, p) => bone.position.fromArray(positions, 3 * p));
      for (let j = 0; j < clip.joints.length; j++) {
        const [w, x, y, z] = rotations.subarray(4 * j, 4 * j + 4);
        bones[j].quaternion.set(x, y, z, w);
      }
    },
  };
}
