// Plays .mcz files. index.d.ts describes what is here.
import { Clip } from "./clip.js";
import { Assets } from "./mcz/assets.js";
import { MczError } from "./mcz/error.js";
import { decoderOf } from "./mcz/decoding.js";
import { instantiate } from "./mcz/instance.js";
import { openMcz } from "./mcz/mcz.js";

export { MczError };

/** Gives a file of this package: in Node from the disk, elsewhere by fetch. */
async function fileOf(path) {
  const url = new URL(`./files/${path}`, import.meta.url);
  if (url.protocol === "file:") {
    const { readFile } = await import("node:fs/promises");
    return readFile(url);
  }
  const response = await fetch(url);
  if (!response.ok) throw new Error(`${url}: ${response.status} ${response.statusText}`);
  return new Uint8Array(await response.arrayBuffer());
}

const own = new Assets(fileOf);

export async function open(contents, { read } = {}) {
  const bytes = contents instanceof Uint8Array ? contents : new Uint8Array(contents);
  const assets = read ? new Assets(read) : own;
  const mcz = await openMcz(bytes, assets);
  const [stream] = mcz.streams;
  if (stream.kind !== "channels") throw new MczError("a stream of a kind that is not known", { found: stream.kind });
  if (stream.model.length) throw new MczError("coded with a model, which this package does not take");
  const decode = await decoderOf(stream, new Uint8Array(0), assets);
  const kinematics = mcz.skeleton ? instantiate(await assets.module("wasm/kinematics.wasm")) : null;
  return new Clip(stream, mcz.skeleton, mcz.chunks[0], decode, kinematics);
}
