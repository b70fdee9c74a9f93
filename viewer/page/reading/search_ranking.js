// Which clips, or which stretches of them, are most like a query (docs/search.md). Stretches are
// ranked by alignment with the query alone: neither examples nor signatures count.
import { SIZE, part } from "./search_record.js";

export const TOP = 20;
const [CLOSELY, AGAIN] = [100, 5];
const [FIRST, THEIRS, MOST_THEIRS] = [3, 1.5, 3];
const [AROUND, CROWDED] = [30, 0.35];
const [FEW, LEAST_SPREAD] = [5, 0.7];
const [SIGNED, ALIGNED] = [55, 1.9];
const FRAMES = 256;
const [ABANDON, ENOUGH] = [3, 5];
const [POWER, OVERLAP] = [5 / 8, 0.5];

/**
 * Rank clips.
 *
 * @param {number} query place of the clip that is sought, which is not found
 * @param {Int8Array[]} signatures of all clips
 * @param {function(number): Promise<import("./search_record.js").Features>} features by place
 * @returns {Promise<{place: number, score: number}[]>} the best first
 */
export async function rank(query, signatures, features) {
  const wanted = TOP + 1; // one is the query
  const near = signatures.map((own) => apart(signatures[query], own));
  const chosen = sorted(near).slice(0, Math.max(CLOSELY, AGAIN * wanted));
  const records = [];
  for (const place of chosen) records.push(await features(place));
  const aligned = alignments(await features(query), records);
  const distances = chosen.map((a) => chosen.map((b) => apart(signatures[a], signatures[b]) / SIGNED));
  const crowded = spread(distances).map((own) => own ** CROWDED);
  const own = chosen.map((place, i) => (near[place] / SIGNED + aligned[i] / ALIGNED) / crowded[i]);
  const best = sorted(own).slice(0, FIRST);
  const scores = own.map((score, i) => {
    const theirs = mean(best.map((other) => distances[other][i])) / crowded[i];
    return score + Math.min(THEIRS * theirs, MOST_THEIRS * score);
  });
  return sorted(scores)
    .map((i) => ({ place: chosen[i], score: scores[i] }))
    .filter(({ place, score }) => place !== query && score < Infinity)
    .slice(0, TOP);
}

/**
 * Find stretches.
 *
 * @param {import("./search_record.js").Features} wanted
 * @param {AsyncIterable<[number, import("./search_record.js").Features]>} clips places, and features
 * @returns {Promise<{place: number, score: number, first: number, last: number}[]>} `last` is behind
 *     the last frame; the best first
 */
export async function find(wanted, clips) {
  const hits = [];
  for await (const [place, motion] of clips) {
    for (const hit of separate(matches(wanted, motion))) hits.push({ place, ...hit });
  }
  return hits.sort((a, b) => a.score - b.score).slice(0, TOP);
}

/** The distance of two signatures. */
function apart(one, other) {
  let sum = 0;
  for (let k = 0; k < one.length; ++k) sum += (one[k] - other[k]) ** 2;
  return Math.sqrt(sum);
}

function sorted(numbers) {
  return [...numbers.keys()].sort((a, b) => numbers[a] - numbers[b] || a - b);
}

function mean(numbers) {
  return numbers.reduce((sum, number) => sum + number, 0) / numbers.length;
}

/** For each clip how far the nearest others are on average. */
function spread(distances) {
  const most = Math.min(AROUND, Math.floor(distances.length / 3));
  if (most < FEW) return distances.map(() => 1);
  const spreads = distances.map((own) => mean([...own].sort((a, b) => a - b).slice(1, most + 1)));
  const ordered = [...spreads].sort((a, b) => a - b);
  const half = ordered.length / 2;
  const median = mean([ordered[Math.ceil(half) - 1], ordered[Math.floor(half)]]);
  return spreads.map((own) => Math.max(own, LEAST_SPREAD * median, 1 / SIGNED));
}

function alignments(wanted, others) {
  const query = thinned(wanted);
  const costs = [];
  let limit = Infinity;
  for (const other of others) {
    costs.push(Math.min(warp(query, thinned(other), limit), limit));
    if (costs.length >= ENOUGH) limit = ABANDON * [...costs].sort((a, b) => a - b)[ENOUGH - 1];
  }
  return costs;
}

/** At most 256 frames. */
function thinned(motion) {
  const step = Math.max(Math.ceil(motion.frames / FRAMES), 1);
  const frames = Math.ceil(motion.frames / step);
  const values = new Float32Array(frames * SIZE);
  for (let i = 0; i < frames; ++i) values.set(part(motion, i * step, i * step + 1).values, i * SIZE);
  return { frames, values };
}

/** The distance of two frames. */
function far(one, i, other, j) {
  let sum = 0;
  for (let k = 0; k < SIZE; ++k) sum += (one.values[i * SIZE + k] - other.values[j * SIZE + k]) ** 2;
  return Math.sqrt(sum);
}

/** The cost of the best alignment of two clips; infinite where it is above the limit. */
function warp(one, other, limit) {
  const both = one.frames + other.frames;
  let above = new Float64Array(other.frames);
  let now = new Float64Array(other.frames);
  for (let i = 0; i < one.frames; ++i) {
    let least = Infinity;
    for (let j = 0; j < other.frames; ++j) {
      const here = far(one, i, other, j);
      let best = i || j ? Infinity : 2 * here;
      if (i && j) best = above[j - 1] + 2 * here;
      if (i) best = Math.min(best, above[j] + here);
      if (j) best = Math.min(best, now[j - 1] + here);
      now[j] = best;
      least = Math.min(least, best);
    }
    if (least > limit * both) return Infinity;
    [above, now] = [now, above];
  }
  return one.frames && other.frames ? above[other.frames - 1] / both : Infinity;
}

/** For each frame of a motion the cost and the beginning of the best match that ends there. */
function matches(wanted, { frames, values }) {
  const motion = { frames, values };
  const made = () => ({ costs: new Float64Array(frames), starts: new Int32Array(frames) });
  const kept = [made(), made(), made()];
  for (let i = 0; i < wanted.frames; ++i) {
    const [now, above, above2] = [kept[i % 3], kept[(i + 2) % 3], kept[(i + 1) % 3]];
    for (let j = 0; j < frames; ++j) {
      const here = far(wanted, i, motion, j) ** POWER;
      let [cost, start] = [i ? Infinity : here, j];
      const take = (from, at, step) => {
        if (from.costs[at] + step < cost) [cost, start] = [from.costs[at] + step, from.starts[at]];
      };
      if (i && j) take(above, j - 1, here);
      if (i && j > 1) take(above, j - 2, here);
      if (i > 1 && j) take(above2, j - 1, 2 * here);
      now.costs[j] = cost;
      now.starts[j] = start;
    }
  }
  const { costs, starts } = kept[(wanted.frames + 2) % 3];
  return { costs: costs.map((cost) => (wanted.frames ? cost / wanted.frames : Infinity)), starts };
}

/** The best stretches that hardly overlap. */
function separate({ costs, starts }) {
  const found = [];
  const left = Float64Array.from(costs);
  while (found.length < TOP) {
    let end = 0;
    for (let j = 1; j < left.length; ++j) if (left[j] < left[end]) end = j;
    if (!(left[end] < Infinity)) break;
    const [first, length] = [starts[end], end - starts[end] + 1];
    found.push({ score: costs[end], first, last: end + 1 });
    for (let j = 0; j < left.length; ++j) {
      const common = Math.min(j, end) - Math.max(starts[j], first) + 1;
      if (common > OVERLAP * Math.min(j - starts[j] + 1, length)) left[j] = Infinity;
    }
    left[end] = Infinity;
  }
  return found;
}
