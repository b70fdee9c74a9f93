/**
 * How far the points of a decoded clip lie from the original's.
 *
 * @typedef {Object} Comparison
 * @property {number} frames that both have
 * @property {number} points
 * @property {Float32Array} errors (F, P) distances in the file's units
 * @property {Float32Array} worst (F,) largest of each frame
 * @property {Float32Array} mean (F,)
 * @property {number} largest of all
 * @property {number} average of all
 */

/**
 * Compare two takes of one skeleton or marker set; null where they are not that.
 *
 * @param {import("./take.js").Take} original
 * @param {import("./take.js").Take} decoded
 * @returns {Comparison|null}
 */
export function compare(original, decoded) {
  if (!sameSkeleton(original, decoded)) return null;
  const { points } = original;
  const frames = Math.min(original.frames, decoded.frames);
  const errors = new Float32Array(frames * points);
  const worst = new Float32Array(frames);
  const mean = new Float32Array(frames);
  const [a, b] = [original.positions, decoded.positions];
  let largest = 0;
  let total = 0;
  for (let frame = 0, i = 0; frame < frames; frame++) {
    let sum = 0;
    for (let point = 0; point < points; point++, i++) {
      const k = 3 * i;
      const error = Math.hypot(a[k] - b[k], a[k + 1] - b[k + 1], a[k + 2] - b[k + 2]);
      errors[i] = error;
      sum += error;
      if (error > worst[frame]) worst[frame] = error;
    }
    mean[frame] = sum / points;
    total += mean[frame];
    largest = Math.max(largest, worst[frame]);
  }
  return { frames, points, errors, worst, mean, largest, average: total / frames };
}

function sameSkeleton(a, b) {
  if (!a.points || a.points !== b.points) return false;
  if (a.clip.markers && a.jointNames.join("\n") !== b.jointNames.join("\n")) return false;
  return a.parents.every((parent, i) => parent === b.parents[i]);
}

/**
 * Mean speed of a take's joints in each frame, in the file's units per second: (F,). Markers that are
 * missing, there or in the frame before, do not count.
 */
export function speeds(take) {
  const { points, positions, frames, frameTime } = take;
  const speed = new Float32Array(frames);
  for (let frame = 1; frame < frames && points; frame++) {
    let sum = 0;
    let counted = 0;
    for (let point = 0; point < points; point++) {
      if (take.isMissing(frame, point) || take.isMissing(frame - 1, point)) continue;
      const k = 3 * (frame * points + point);
      const before = k - 3 * points;
      counted++;
      sum += Math.hypot(
        positions[k] - positions[before],
        positions[k + 1] - positions[before + 1],
        positions[k + 2] - positions[before + 2],
      );
    }
    speed[frame] = counted ? sum / counted / frameTime : 0;
  }
  if (frames > 1) speed[0] = speed[1];
  return speed;
}
