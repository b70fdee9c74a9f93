// Reads files beside the page: ./reader.js asks.
import { Assets } from "../../mcz/assets.js";
import { embeddedClips } from "../reading/embedded.js";
import { FileError } from "../reading/file_error.js";
import { message, readFiles } from "../reading/files.js";
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

/** @param {{id: number, files?: {name: string, bytes: Uint8Array}[], text?: string}} question */
export async function answer({ id, files, text }) {
  const { clips, errors } = files ? await readFiles(files, assets) : await embeddedClips(text, assets);
  const made = [];
  for (const clip of clips) {
    try {
      made.push(await placed(clip, assets));
    } catch (error) {
      errors.push(message(error, clip.name));
    }
  }
  const buffers = made.flatMap(({ channels, positions }) => [...channels, positions].map(bufferOf));
  postMessage({ id, read: { clips: made, errors } }, [...new Set(buffers)]);
}

function bufferOf({ buffer }) {
  return buffer;
}
