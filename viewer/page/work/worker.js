// Reads files beside the page: ./reader.js asks.
import { Assets } from "../../mcz/assets.js";
import { embeddedClips } from "../reading/embedded.js";
import { FileError } from "../reading/file_error.js";
import { message as messageOf, readFiles } from "../reading/files.js";
import { SqliteLibrary } from "../reading/library.js";
import { placed } from "./placing.js";

let assets;
let library;

/** @param {Object<string, Uint8Array>} carried the page's binary files */
export function begin(carried) {
  assets = new Assets((path) => {
    if (!Object.hasOwn(carried, path)) {
      throw new FileError("this page does not carry the decoder", {
        expected: "a page of `mocapress view`, which carries all",
        found: path,
      });
    }
    return carried[path];
  });
}

/**
 * Read files or what the page carries; of long clips first only the beginning, which is told early.
 *
 * @param {{id: number, files?: {name: string, bytes: Uint8Array}[], text?: string, library?: Object,
 *     stored?: number, similar?: number, stretch?: [number, number], name?: string}} question of
 *     ./reader.js
 */
export async function answer({ id, ...question }) {
  const { files, text, stored, name } = question;
  if (question.library) {
    postMessage({ id, early: false, read: await opened(question.library) });
    return;
  }
  if (question.similar) {
    postMessage({ id, early: false, read: await similar(question) });
    return;
  }
  const read = (early) => {
    if (files) return readFiles(files, assets, early);
    return stored ? readStored(stored, name, early) : embeddedClips(text, assets, early);
  };
  let found = await read(true);
  if (found.clips.some(({ more }) => more)) {
    await tell({ id, early: true }, found);
    found = await read(false);
  }
  await tell({ id, early: false }, found);
}

async function opened({ file, code, wasm }) {
  const url = URL.createObjectURL(new Blob([code], { type: "text/javascript" }));
  try {
    const { default: init } = await import(url);
    library = await SqliteLibrary.open(file.bytes, init, wasm, assets);
    return { clips: library.catalogue(), errors: [] };
  } catch (error) {
    return { clips: [], errors: [messageOf(error, file.name)] };
  } finally {
    URL.revokeObjectURL(url);
  }
}

async function similar({ similar: id, name, stretch }) {
  try {
    return { hits: await library.similar(id, stretch), errors: [] };
  } catch (error) {
    return { hits: [], errors: [messageOf(error, name)] };
  }
}

async function readStored(id, name, early) {
  try {
    return { clips: [await library.read(id, early)], errors: [] };
  } catch (error) {
    return { clips: [], errors: [messageOf(error, name)] };
  }
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
