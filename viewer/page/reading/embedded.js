import { message, fromDiffma } from "./files.js";
import { readMcz } from "./mcz.js";

/**
 * The clips that the page itself carries.
 *
 * Each has a `name` and either `mcz`, a file in base64, or `diffma`, a document, with the
 * `angleUnit` of its channels and the `maxError` that was asked for.
 *
 * @param {string} text JSON
 * @param {import("../../mcz/assets.js").Assets} assets
 * @param {boolean} [early] whether of long clips only the first frames are read
 * @returns {Promise<{clips: import("./clip.js").Clip[], errors: string[]}>}
 */
export async function embeddedClips(text, assets, early = false) {
  const clips = [];
  const errors = [];
  for (const { name, mcz, diffma, angleUnit, maxError } of JSON.parse(text).clips) {
    try {
      const clip = mcz
        ? await readMcz(bytesOf(mcz), [], null, assets, early)
        : { ...fromDiffma(diffma), angleUnit, maxError };
      clips.push({ ...clip, name });
    } catch (error) {
      errors.push(message(error, name));
    }
  }
  return { clips, errors };
}

function bytesOf(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return bytes;
}
