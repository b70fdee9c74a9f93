const RARE = 0.005; // share of values at each end
const FAR = 20; // heights of the plot beyond which a line need not be told from a vertical one

/**
 * Trace values over the width of a canvas; of many frames per pixel, the least and the largest.
 * Where there is none, NaN, the curve is interrupted.
 *
 * @param {CanvasRenderingContext2D} context
 * @param {Float32Array|Float64Array} values (F,)
 * @param {{left: number, top: number, width: number, height: number}} box
 * @param {[number, number]} range at the bottom and the top of the box
 */
export function trace(context, values, box, [low, high]) {
  const { left, top, width, height } = box;
  const span = high - low || 1;
  const within = (value) => Math.max(-FAR, Math.min(FAR, (value - low) / span));
  const y = (value) => top + height - within(value) * height;
  const last = Math.max(1, values.length - 1);
  const pixels = Math.max(1, Math.floor(width));
  context.beginPath();
  let drawing = false;
  const to = (x, value) => {
    if (!Number.isNaN(value)) context[drawing ? "lineTo" : "moveTo"](x, y(value));
    drawing = !Number.isNaN(value);
  };
  if (values.length <= 2 * pixels) {
    values.forEach((value, i) => to(left + (i / last) * width, value));
  } else {
    for (let pixel = 0; pixel <= pixels; pixel++) {
      const begin = Math.floor((pixel / (pixels + 1)) * values.length);
      const end = Math.max(begin + 1, Math.floor(((pixel + 1) / (pixels + 1)) * values.length));
      const some = values.subarray(begin, end);
      const [least, most] = some.every(Number.isNaN) ? [NaN, NaN] : rangeOf(some);
      to(left + pixel, least);
      to(left + pixel, most);
    }
  }
}

/** Least and largest of some values, those that are finite. */
export function rangeOf(values) {
  let low = Infinity;
  let high = -Infinity;
  for (const value of values) {
    if (value < low) low = value;
    if (value > high && value !== Infinity) high = value;
  }
  return low <= high ? [low, high] : [0, 0];
}

/** The range of some values without rare ones that lie far outside it; those leave the plot. */
export function usualRange(values) {
  const sorted = Float64Array.from(values).filter(Number.isFinite).sort();
  if (!sorted.length) return [0, 0];
  const at = (share) => sorted[Math.round(share * (sorted.length - 1))];
  const [low, high] = [at(RARE), at(1 - RARE)];
  const room = high - low;
  const [least, most] = [sorted[0], sorted.at(-1)];
  return [least < low - room ? low : least, most > high + room ? high : most];
}

/** A number as short as can be read. */
export function short(value) {
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size < 1e-3 || size >= 1e5) return value.toExponential(1).replace("e+", "e");
  return String(Number(value.toPrecision(size >= 1 ? 4 : 3)));
}
