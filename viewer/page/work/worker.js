// Reads files beside the page: ./reader.js asks.
import { Assets } from "../../mcz/assets.js";
import { embeddedClips } from "../reading/embedded.js";
import { FileError } from "../reading/file_error.js";
import { message as messageOf, readFiles } from "../reading/files.js";
import { placed } from "./placing.js";

let assets;

/** @param {Object<string, string>} carried the page's binary files, in base64 */
export function begin(carried) {
  assets = new Assets((path) => {
    if (!Object.hasOwn(carried, path)) {
      throw new FileError("this page does not carry the decoder", {
        expected: "a page of `mocapress view`, which carries all",
        found: path,
      });
    }
    return Uint8Array.from(atob(carried[path]), (character) => character.charCodeAt(0));
  });
}

/**
 * Read files or what the page carries; of long clips first only the beginning, which is told early.
 *
 * @param {{id: number, files?: {name: string, bytes: Uint8Array}[], text?: string}} question
 */
export async function answer({ id, files, text }) {
  const read = (early) =>
    files ? readFiles(files, assets, early) : embeddedClips(text, assets, early);
  let found = await read(true);
  if (found.clips.some(({ more }) => more)) {
    await tell({ id, early: true }, found);
    found = await read(false);
  }
  await tell({ id, early: false }, found);
}

async function tell(message, { clips, errors }) {
  const made = [];
  for (const clip of clips) {
    try {
      made.push(await placed(clip, assets));
    } catch (error) {
      errors.push(messageOf(error, clip.name));
    }
  }
  const buffers = made.flatMap(({ channels, positions, gaps }) =>
    [...channels, positions, ...(gaps ? [gaps] : [])].map(bufferOf),
  );
  postMessage({ ...message, read: { clips: made, errors } }, [...new Set(buffers)]);
}

function bufferOf({ buffer }) {
  return buffer;
}
