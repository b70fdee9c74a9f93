/** Of a figure on the stage. */
export const USUAL_HEIGHT = 1.7;

const FRAMES = 240; // that are looked at, spread over the clip
const MANY = 20; // markers among which one may be a stray
const NEAR_FLOOR = 0.06; // of the figure's size
const MOST_NEAR = 5; // points that stand on the floor: more of them say no more
const POINT_COUNTS = 0.15; // beside a figure that is upright all the time
const UPRIGHT = 0.6; // from feet to head, of the figure's size
const UPPER = /head|neck|skull|face|[fb]hd$|^c7$|clav$/i;
const LOWER = /foot|toe|ankle|heel|[lr](ank|hee)$/i;
const AXES = [
  [1, 1],
  [2, 1],
  [0, 1],
  [1, -1],
  [2, -1],
  [0, -1],
];

/**
 * @typedef {Object} Bearings where a clip stands, found from its motion
 * @property {[number, number]} up axis (0 to 2) and sign
 * @property {number} scale by which lengths are multiplied, so that a figure is about 1.7 high
 * @property {number} floor height of the floor along `up`, in the file's units
 * @property {number[]} centre middle of the way, on the floor; after turning and scaling
 * @property {number} reach how far the motion goes from there
 * @property {number} facing angle about +y of where the figure looks at first, 0 along +z
 */

/**
 * Find what users of other players set by hand: scale, up axis, floor and extent.
 *
 * @param {Float32Array} positions (F, P, 3)
 * @param {number} points P
 * @param {string[]} names of the joints, the first of the points
 * @param {Object} [known]
 * @param {[number, number]} [known.up] the up axis
 * @param {Uint8Array} [known.gaps] of markers (F, P): not 0 where one is missing. Their way is that of
 *     their middle; else it is that of the root
 * @param {number} [known.root] the joint that leads the way; points before it are no part of the figure
 * @param {Float32Array} [known.rest] places of the joints at rest
 * @returns {Bearings}
 */
export function findBearings(positions, points, names, { up: given, gaps, root = 0, rest } = {}) {
  const all = sampled(positions, points, gaps);
  const frames = root ? all.map((frame) => frame.subarray(3 * root)) : all;
  if (root) names = names.slice(root);
  const strays = gaps && points >= MANY ? 1 : 0;
  const sizes = frames.map((frame) =>
    Math.max(...[0, 1, 2].map((axis) => extent(frame, axis, strays))),
  );
  const size = quantile(sizes, 0.75) || 1;
  const up = given ?? upAxis(frames, names, size, rest?.subarray(3 * root));
  const scale = USUAL_HEIGHT / size;
  const heights = frames.map((frame) => lowest(frame, up));
  const floor = quantile(heights, 0.05) || 0;
  const turn = turnUp(up);
  const low = [Infinity, Infinity];
  const high = [-Infinity, -Infinity];
  for (const frame of frames) {
    const leading = [...Array(gaps ? points : 1).keys()];
    const place = turn(...[0, 1, 2].map((axis) => mean(frame, leading, axis)));
    [place[0], place[2]].forEach((value, k) => {
      low[k] = Math.min(low[k], value);
      high[k] = Math.max(high[k], value);
    });
  }
  const middle = low.map((value, k) => (Number.isFinite(value) ? (value + high[k]) / 2 : 0));
  const way = Math.hypot(high[0] - low[0], high[1] - low[1]) * scale;
  return {
    up,
    scale,
    floor,
    centre: [middle[0] * scale, 0, middle[1] * scale],
    reach: Number.isFinite(way) ? way / 2 : 0,
    facing: frames.length ? facing(frames[0], names, turn) : 0,
  };
}

/** The turn that leads an up axis to +y, keeping the hand: (x, y, z) to a new [x, y, z]. */
export function turnUp([axis, sign]) {
  if (axis === 1) return sign > 0 ? (x, y, z) => [x, y, z] : (x, y, z) => [x, -y, -z];
  if (axis === 2) return sign > 0 ? (x, y, z) => [x, z, -y] : (x, y, z) => [x, -z, y];
  return sign > 0 ? (x, y, z) => [-y, x, z] : (x, y, z) => [y, -x, z];
}

/** Name of an up axis: `+z`. */
export function axisName([axis, sign]) {
  return `${sign > 0 ? "+" : "−"}${"xyz"[axis]}`;
}

/** The up axis that follows, for one who chooses by hand. */
export function nextUp([axis, sign]) {
  const here = AXES.findIndex(([a, s]) => a === axis && s === sign);
  return AXES[(here + 1) % AXES.length];
}

/** Some frames; markers that are missing in them stand in the middle of the others. */
function sampled(positions, points, gaps) {
  const width = 3 * points;
  const count = width ? positions.length / width : 0;
  const step = Math.max(1, count / FRAMES);
  const frames = [];
  for (let at = 0; at < count; at += step) {
    let frame = positions.subarray(Math.floor(at) * width, (Math.floor(at) + 1) * width);
    if (gaps) frame = withoutGaps(frame, gaps.subarray(Math.floor(at) * points));
    if (frame.every(Number.isFinite)) frames.push(frame);
  }
  return frames;
}

function withoutGaps(frame, gaps) {
  const made = frame.slice();
  const all = [...Array(frame.length / 3).keys()];
  const seen = all.filter((point) => !gaps[point]);
  for (let axis = 0; axis < 3 && seen.length; axis++) {
    const middle = mean(frame, seen, axis);
    for (const point of all) if (gaps[point]) made[3 * point + axis] = middle;
  }
  return made;
}

/**
 * From feet to head, where the names tell; and away from where most points touch the floor. Who does
 * push-ups lies most of the time: how the skeleton stands at rest counts, as far as the figure ever
 * stands so in motion. Without names, where figures are long and wander little.
 */
function upAxis(frames, names, size, rest) {
  const upper = indices(names, UPPER);
  const lower = indices(names, LOWER);
  if (!upper.length || !lower.length) return longAxis(frames);
  const towards = (frame, axis) => mean(frame, upper, axis) - mean(frame, lower, axis);
  const standing = rest ? [0, 1, 2].map((axis) => towards(rest, axis)) : [0, 0, 0];
  const scores = AXES.map(([axis, sign]) => {
    const upright = frames.map((frame) => (sign * towards(frame, axis)) / size);
    const heights = frames.map((frame) => lowest(frame, [axis, sign]));
    const floor = quantile(heights, 0.05);
    const isNear = (x, i) => i % 3 === axis && sign * x - floor < NEAR_FLOOR * size;
    const near = average(frames.map((frame) => frame.filter(isNear).length));
    const atRest = sign * standing[axis] > 0.8 * Math.hypot(...standing);
    const ever = Math.min(1, Math.max(0, (quantile(upright, 0.98) ?? 0) / UPRIGHT));
    return average(upright) + POINT_COUNTS * Math.min(MOST_NEAR, near) + (atRest ? ever : 0);
  });
  return AXES[scores.indexOf(Math.max(...scores))];
}

/** Files have y or z up; x is not thought of. */
function longAxis(frames) {
  const lengths = [0, 1, 2].map(
    (axis) =>
      average(frames.map((frame) => extent(frame, axis))) -
      range(frames.map((frame) => frame[axis])),
  );
  return [lengths[2] > 1.2 * lengths[1] ? 2 : 1, 1];
}

/** From its left to its right side, and from there to the front, where the names tell. */
function facing(frame, names, turn) {
  const place = new Map(names.map((name, i) => [name.toLowerCase(), i]));
  const across = [0, 0, 0];
  for (const [name, left] of place) {
    const other = name.includes("left") ? name.replace("left", "right") : name.replace(/^l/, "r");
    const right = other === name ? undefined : place.get(other);
    if (right === undefined) continue;
    for (let axis = 0; axis < 3; axis++) {
      across[axis] += frame[3 * right + axis] - frame[3 * left + axis];
    }
  }
  const [x, , z] = turn(...across);
  return x || z ? Math.atan2(z, -x) : 0;
}

function indices(names, pattern) {
  return [...names.keys()].filter((i) => pattern.test(names[i]));
}

function average(values) {
  return values.length ? values.reduce((sum, value) => sum + value, 0) / values.length : 0;
}

function mean(frame, joints, axis) {
  return joints.reduce((sum, joint) => sum + frame[3 * joint + axis], 0) / joints.length;
}

/** How far points reach along an axis, but for so many strays at both ends. */
function extent(frame, axis, strays = 0) {
  const sorted = frame.filter((_, i) => i % 3 === axis).sort((a, b) => a - b);
  return sorted.length ? sorted.at(-1 - strays) - sorted[strays] : -Infinity;
}

function lowest(frame, [axis, sign]) {
  let low = Infinity;
  for (let i = axis; i < frame.length; i += 3) low = Math.min(low, sign * frame[i]);
  return low;
}

function range(values) {
  return values.length ? Math.max(...values) - Math.min(...values) : 0;
}

function quantile(values, share) {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[Math.floor(share * (sorted.length - 1))];
}
