import { bonesOf } from "./marker_sets.js";

const NO_PLACE = /(angles?|forces?|moments?|powers?|grf)$/i; // what models write among the points

/**
 * @typedef {Object} Markers
 * @property {string[]} labels those that are drawn, then those that have curves only
 * @property {number} drawn how many are
 * @property {string} unit
 * @property {[number, number][]} bones between markers that are drawn
 */

/**
 * Make a clip of markers.
 *
 * @param {Object} told
 * @param {string[]} told.labels
 * @param {string} told.unit
 * @param {Float64Array[]} told.places x, y and z of each marker; NaN where it is missing
 * @param {number} told.frames
 * @param {number|null} told.frameTime seconds
 * @param {Set<string>} [told.noPlaces] labels of points that are no places in space
 * @param {{name: string, unit: string, values: Float64Array}[]} [told.analog] sampled as often, or
 *     several times a frame
 * @returns {import("./clip.js").Clip}
 */
export function markerClip({ labels: told, unit, places, frames, frameTime, noPlaces, analog = [] }) {
  const labels = distinct(told);
  for (let i = 0; i < places.length; i += 3) withoutZeros(places.slice(i, i + 3));
  const seen = (i) => places[3 * i].some((x) => !Number.isNaN(x));
  const isDrawn = (i) => !noPlaces?.has(told[i]) && !NO_PLACE.test(labels[i]) && seen(i);
  const all = [...labels.keys()];
  const drawn = all.filter(isDrawn);
  const order = [...drawn, ...all.filter((i) => !drawn.includes(i))];
  const sorted = order.map((i) => labels[i]);
  const never = all.filter((i) => !seen(i)).length;
  return {
    names: [
      ...sorted.flatMap((label) => ["x", "y", "z"].map((axis) => `${label}.${axis}`)),
      ...distinct(analog.map(({ name }) => name)).map((name, i) =>
        analog[i].unit ? `${name} [${analog[i].unit}]` : name,
      ),
    ],
    frames,
    channels: [
      ...order.flatMap((i) => places.slice(3 * i, 3 * i + 3)),
      ...analog.map(({ values }) => values),
    ],
    skeleton: null,
    frameTime,
    markers: { labels: sorted, drawn: drawn.length, unit, bones: bonesOf(sorted.slice(0, drawn.length)) },
    notes: never ? [`${never} of ${labels.length} markers are never seen`] : [],
  };
}

/** Many programs write 0, 0, 0 for a marker that is missing. */
function withoutZeros(place) {
  for (let frame = 0; frame < place[0].length; frame++) {
    if (place.every((values) => values[frame] === 0)) for (const values of place) values[frame] = NaN;
  }
}

/** Names of which one that is there again is `name#2`. */
function distinct(names) {
  const seen = new Map();
  return names.map((name) => {
    const count = (seen.get(name) ?? 0) + 1;
    seen.set(name, count);
    return count === 1 ? name : `${name}#${count}`;
  });
}
