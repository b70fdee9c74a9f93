/**
 * @typedef {Object} Joint
 * @property {string} name
 * @property {number} parent index, -1 for a root; smaller than the joint's own
 * @property {number[]} offset from the parent's joint, in its frame
 * @property {string[]} channels tx ty tz rx ry rz l, in the file's order
 * @property {number[]} axis ASF: angles of the frame in which the channels turn
 * @property {string} axisOrder the order in which they are applied, about fixed axes
 * @property {number[][]} ends the far ends of bones that carry no further joint
 *
 * @typedef {Object} Skeleton
 * @property {"moving"|"fixed"} rotation channels turn from left to right (BVH) or right to left
 * @property {"deg"|"rad"} angleUnit
 * @property {number|null} lengthUnit
 * @property {Joint[]} joints
 * @property {[number, string][]} columns joint and kind of each channel
 */

/** Names of a skeleton's columns, as mocapress gives them: `hip.rx`; `hip#2.rx` for a namesake. */
export function channelNames(skeleton) {
  const seen = new Map();
  const labels = new Map();
  return skeleton.columns.map(([joint, kind]) => {
    if (!labels.has(joint)) {
      const { name } = skeleton.joints[joint];
      const nth = (seen.get(name) ?? 0) + 1;
      seen.set(name, nth);
      labels.set(joint, nth === 1 ? name : `${name}#${nth}`);
    }
    return `${labels.get(joint)}.${kind}`;
  });
}
