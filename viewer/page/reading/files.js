import { decode, DiffmaError } from "../../diffma/diffma.js";
import { parseAmc } from "./amc.js";
import { parseAsf } from "./asf.js";
import { parseBvh } from "./bvh.js";
import { FileError } from "./file_error.js";
import { latin1 } from "./scanner.js";
import { channelNames } from "./skeleton.js";

/**
 * Read dropped files.
 *
 * @param {{name: string, bytes: Uint8Array}[]} files
 * @returns {{clips: import("./clip.js").Clip[], errors: string[]}}
 */
export function readFiles(files) {
  const clips = [];
  const errors = [];
  const skeletons = files.filter((file) => ending(file) === "asf");
  const motions = files.filter((file) => ending(file) !== "asf");
  for (const file of motions.length ? motions : skeletons) {
    try {
      clips.push({ ...readFile(file, skeletons), name: file.name });
    } catch (error) {
      errors.push(message(error, file.name));
    }
  }
  return { clips, errors };
}

function readFile(file, skeletons) {
  switch (ending(file)) {
    case "bvh":
      return parseBvh(file.bytes);
    case "amc": {
      const beside = skeletonOf(file, skeletons);
      return parseAmc(file.bytes, beside ? readSkeleton(beside) : null);
    }
    case "json":
      return fromDiffma(new TextDecoder().decode(file.bytes));
    case "asf":
      throw new FileError("a skeleton without motion", { expected: "an .amc dropped with it" });
    default:
      throw new FileError("not a file that this page plays", {
        expected: ".bvh, .amc with its .asf, or .diffma.json",
      });
  }
}

/**
 * The clip of a DiffMA document.
 *
 * @param {string|object} document
 * @returns {import("./clip.js").Clip}
 * @throws {DiffmaError} with the JSON path of what is wrong
 */
export function fromDiffma(document) {
  const { names, frames, channels, skeleton, frameTime } = decode(document);
  return {
    names: names ?? (skeleton ? channelNames(skeleton) : channels.map((_, i) => `channel ${i}`)),
    frames,
    channels,
    skeleton: skeleton ?? null,
    frameTime: frameTime ?? null,
    notes: skeleton ? [] : ["no skeleton in this file: only its curves can be shown"],
  };
}

/** The message for a user. */
export function message(error, file) {
  if (error instanceof FileError) return error.of(file).message;
  if (error instanceof DiffmaError) return `${file}: ${error.message}`;
  if (error instanceof RangeError) return `${file}: too large for this browser's memory`;
  throw error;
}

/** The ASF of an AMC among others: of the same name, of the subject, or the only one. */
function skeletonOf(amc, skeletons) {
  const stem = stemOf(amc);
  const subject = skeletons
    .filter(
      (asf) => stem.startsWith(stemOf(asf)) && /^[_\-. ]/.test(stem.slice(stemOf(asf).length)),
    )
    .sort((a, b) => b.name.length - a.name.length);
  const only = skeletons.length === 1 ? skeletons[0] : undefined;
  return skeletons.find((asf) => stemOf(asf) === stem) ?? subject[0] ?? only;
}

function readSkeleton(file) {
  try {
    return parseAsf(latin1(file.bytes));
  } catch (error) {
    throw error instanceof FileError ? error.of(file.name) : error;
  }
}

function ending(file) {
  return file.name.toLowerCase().split(".").at(-1);
}

function stemOf(file) {
  return file.name.toLowerCase().replace(/\.[^.]*$/, "");
}
