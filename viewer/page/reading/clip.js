/**
 * @typedef {Object} Clip
 * @property {string} [name]
 * @property {string[]} names of the channels
 * @property {number} frames F
 * @property {Float64Array[]} channels (F,) each, in the units of the file
 * @property {import("./skeleton.js").Skeleton|null} skeleton null: there are curves, but no figure
 * @property {number|null} frameTime seconds; null where the file does not say
 * @property {"deg"|"rad"} [angleUnit] of the channels, where not the skeleton's
 * @property {number} [maxError] that no value exceeds, where that was asked for
 * @property {import("./markers.js").Markers} [markers] of clips of points; their channels are x, y and z
 *     of each marker, NaN where it is missing, then analog ones, which may have several values a frame
 * @property {boolean} [more] whether these are only the first frames of many
 * @property {string[]} [notes] what the page should say of it
 */

/** Frames per second of an AMC, which does not say; those of the CMU database. */
export const DEFAULT_FPS = 120;

/** Seconds per frame. */
export function secondsPerFrame(clip) {
  return clip.frameTime > 0 ? clip.frameTime : 1 / DEFAULT_FPS;
}
