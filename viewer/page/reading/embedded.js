import { FileError } from "./file_error.js";
import { fromDiffma, message } from "./files.js";

/**
 * The clips that the page itself carries.
 *
 * Each has a `name`, the `angleUnit` of its channels, and `diffma`, a document, with the `maxError`
 * that was asked for; or `exact`: `names`, `frames`, `skeleton`, `frameTime` and
 * `values`, all channels one after another, float64 little-endian, in base64.
 *
 * @param {string} text JSON
 * @returns {{clips: import("./clip.js").Clip[], errors: string[]}}
 */
export function embeddedClips(text) {
  const clips = [];
  const errors = [];
  for (const { name, angleUnit, maxError, diffma, exact } of JSON.parse(text).clips) {
    try {
      const clip = diffma ? fromDiffma(diffma) : fromExact(exact);
      clips.push({ ...clip, name, angleUnit, maxError });
    } catch (error) {
      errors.push(message(error, name));
    }
  }
  return { clips, errors };
}

function fromExact({ names, frames, skeleton, frameTime, values }) {
  const text = atob(values);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  if (bytes.length !== 8 * frames * names.length) {
    throw new FileError("values", {
      expected: `${8 * frames * names.length} bytes`,
      found: String(bytes.length),
    });
  }
  const all = new Float64Array(bytes.buffer);
  return {
    names,
    frames,
    channels: names.map((_, i) => all.subarray(i * frames, (i + 1) * frames)),
    skeleton: skeleton ? withDefaults(skeleton) : null,
    frameTime: frameTime ?? null,
    notes: skeleton ? [] : ["no skeleton: only its curves can be shown"],
  };
}

/** DiffMA JSON leaves out what a joint has not. */
function withDefaults(skeleton) {
  const nothing = { channels: [], axis: [0, 0, 0], axisOrder: "xyz", ends: [] };
  return { ...skeleton, joints: skeleton.joints.map((joint) => ({ ...nothing, ...joint })) };
}
