import { decode, DiffmaError } from "../../diffma/diffma.js";
import { MczError } from "../../mcz/error.js";
import { unpackXz } from "../../mcz/xz.js";
import { readC3d } from "./c3d.js";
import { FileError } from "./file_error.js";
import { readMcz } from "./mcz.js";
import { readAmc, readBvh } from "./motion_file.js";
import { channelNames } from "./skeleton.js";
import { readTrc } from "./trc.js";

const MOST_JSON = 2 ** 29; // bytes: as long as a text can be in a browser

/**
 * Read dropped files. Skeletons and models are there for the others.
 *
 * @param {{name: string, bytes: Uint8Array}[]} files
 * @param {import("../../mcz/assets.js").Assets} assets
 * @param {boolean} [early] whether of long clips only the first frames are read
 * @returns {Promise<{clips: import("./clip.js").Clip[], errors: string[]}>}
 */
export async function readFiles(files, assets, early = false) {
  const clips = [];
  const errors = [];
  const motions = files.filter((file) => !["asf", "mcm"].includes(ending(file)));
  for (const file of motions.length ? motions : files) {
    try {
      clips.push({ ...(await readFile(file, files, assets, early)), name: file.name });
    } catch (error) {
      errors.push(message(error, file.name));
    }
  }
  return { clips, errors };
}

async function readFile(file, files, assets, early) {
  const among = (kind) => files.filter((other) => ending(other) === kind);
  switch (ending(file)) {
    case "bvh":
      return readBvh(file.bytes, assets);
    case "amc":
      return readAmc(file.bytes, skeletonOf(file, among("asf")), assets);
    case "c3d":
      return readC3d(file.bytes, assets);
    case "trc":
      return readTrc(file.bytes);
    case "json":
      return fromDiffma(new TextDecoder().decode(file.bytes));
    case "xz": {
      const xz = await assets.module("vendor/xz/xz.wasm");
      return fromDiffma(new TextDecoder().decode(unpackXz(xz, file.bytes, MOST_JSON)));
    }
    case "mcz": {
      const models = among("mcm").map(({ bytes }) => bytes);
      return readMcz(file.bytes, models, skeletonOf(file, among("asf")), assets, early);
    }
    case "mcm":
      throw new FileError("a model without motion", { expected: "a .mcz dropped with it" });
    case "asf":
      throw new FileError("a skeleton without motion", { expected: "an .amc dropped with it" });
    default:
      throw new FileError("not a file that this page plays", {
        expected: ".bvh, .amc with its .asf, .c3d, .trc, .mcz, or .diffma.json",
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
  if (error instanceof MczError && error.message.startsWith("byte ")) {
    return `${file}, ${error.message}`;
  }
  if (error instanceof MczError || error instanceof DiffmaError) return `${file}: ${error.message}`;
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
  return skeletons.find((asf) => stemOf(asf) === stem) ?? subject[0] ?? only ?? null;
}

function ending(file) {
  return file.name.toLowerCase().split(".").at(-1);
}

function stemOf(file) {
  return file.name.toLowerCase().replace(/\.mcz$/, "").replace(/\.[^.]*$/, "");
}
