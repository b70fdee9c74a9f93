// Reads libraries (docs/format/library.md) by SQLite's own WebAssembly build, in viewer/vendor/sqlite.
import { decodeStream, mczOfParts } from "../../mcz/mcz.js";
import { FileError } from "./file_error.js";
import { readOpened } from "./mcz.js";
import { find, rank } from "./search_ranking.js";
import { NOTHING, RATE, part, readRecord } from "./search_record.js";

const APPLICATION_ID = 0x4d435a4c;
const VERSION = 5;
const TABLES = ["clips", "chunks", "runs", "texts", "skeletons", "labels", "models"];
const [JOURNAL, NOT_WAL] = [18, 1]; // where the header says that there is a write-ahead log

const CATALOGUE = `
  SELECT clips.id AS id, clips.name AS name, coalesce(format, '') AS format, frames,
      frames * frame_time AS seconds, skeletons.name AS skeleton,
      (SELECT group_concat(label, char(0)) FROM labels WHERE clip = clips.id) AS labels
  FROM clips LEFT JOIN skeletons ON skeletons.id = skeleton WHERE frames > 0 ORDER BY clips.name`;
const clipOf = (own) => `
  SELECT clips.name AS name, file, format, size, sha256, problems, head, record AS skeleton,
      packed AS text, list, sections, ${own}
  FROM clips LEFT JOIN skeletons ON skeletons.id = skeleton LEFT JOIN texts ON texts.id = text
      LEFT JOIN chunks ON chunks.clip = clips.id WHERE clips.id = ?`;
const RUNS = `
  SELECT stream, first, frames, source, source_first AS sourceFirst FROM runs WHERE clip = ?
  ORDER BY stream, first`;

const INDEX = 1; // version of what is compared in a search
const ASSUMED_RATE = 120; // of a clip that states none
const SIGNATURES = `
  SELECT clip, signature, frames, coalesce(frame_time, 1.0 / ${ASSUMED_RATE}) AS frameTime
  FROM signatures JOIN clips ON clips.id = clip
  WHERE version = ${INDEX} AND length(signature) = 64 ORDER BY clip`;

const FEATURES = "SELECT rows FROM features WHERE clip = ?";
const NEEDS = "SELECT EXISTS (SELECT 1 FROM needs WHERE clip = ?)";

/** A library in memory; it is only read. */
export class SqliteLibrary {
  #hasNeeds = false;
  #hasIndex = false;
  #clip = "";

  /**
   * @param {Uint8Array} bytes the file, which is changed: a library on a disk keeps a log, one here
   *     does not
   * @param {function(object): Promise<object>} init the default export of SQLite's module
   * @param {Uint8Array} wasm
   * @param {import("../../mcz/assets.js").Assets} assets
   * @returns {Promise<SqliteLibrary>}
   * @throws {FileError} when it is no library
   */
  static async open(bytes, init, wasm, assets) {
    // What is wrong with a file is told on the page, not on the console.
    globalThis.sqlite3ApiConfig = { warn: () => {} };
    const sqlite = await init({ wasmBinary: wasm, locateFile: (name) => name });
    bytes.fill(NOT_WAL, JOURNAL, JOURNAL + 2);
    const { capi, oo1 } = sqlite;
    const db = new oo1.DB(":memory:");
    const place = sqlite.wasm.allocFromTypedArray(bytes);
    const flags = capi.SQLITE_DESERIALIZE_FREEONCLOSE | capi.SQLITE_DESERIALIZE_READONLY;
    db.checkRc(capi.sqlite3_deserialize(db, "main", place, bytes.length, bytes.length, flags));
    const library = new SqliteLibrary(db, assets);
    library.#check();
    return library;
  }

  constructor(db, assets) {
    this.db = db;
    this.assets = assets;
  }

  #check() {
    const found = this.#said(() => this.db.selectValue("PRAGMA application_id"));
    if (found !== APPLICATION_ID) throw new FileError("not a library");
    const version = this.db.selectValue("PRAGMA user_version");
    if (!(version >= 1 && version <= VERSION)) {
      const expected = `1 to ${VERSION}`;
      throw new FileError("version of the library", { expected, found: version });
    }
    // A view may compute for ever, a table may not.
    const tables = this.db.selectValues("SELECT name FROM sqlite_schema WHERE type = 'table'");
    const missing = TABLES.find((table) => !tables.includes(table));
    if (missing) throw new FileError("not the tables of a library", { expected: missing });
    this.#clip = clipOf(version < 5 ? "NULL AS sample, NULL AS layout" : "sample, layout");
    this.#hasNeeds = tables.includes("needs"); // from version 2 on
    this.#hasIndex = ["signatures", "features"].every((name) => tables.includes(name)); // from 3 on
  }

  /** @returns {import("../panels/library.js").StoredClip[]} */
  catalogue() {
    return this.#said(() => this.db.selectObjects(CATALOGUE)).map((clip) => ({
      ...clip,
      labels: clip.labels ? clip.labels.split("\0").sort() : [],
    }));
  }

  /**
   * Decode a clip; frames that it shares are taken from the others.
   *
   * @param {number} id
   * @param {boolean} early as of `readMcz`
   * @returns {Promise<import("./clip.js").Clip>}
   */
  async read(id, early) {
    const clip = await this.#open(id);
    const models = this.#said(() => this.db.selectValues("SELECT file FROM models"));
    const runs = this.#said(() => this.db.selectObjects(RUNS, [id]));
    if (runs.length) {
      const own = clip.mcz.chunks;
      clip.mcz.chunks = own.map((chunks, stream) => piecesOf(chunks, runs, stream, id));
      clip.mcz.decode = (stream) => this.#decode({ ...clip.mcz, own }, stream, id, models);
    }
    return { ...(await readOpened(clip.mcz, models, null, this.assets, early)), name: clip.name };
  }

  /**
   * Find what is like a clip, or like a stretch of it.
   *
   * @param {number} id
   * @param {[number, number]|null} stretch the first frame, and the one behind the last
   * @returns {Promise<import("../panels/library.js").Hit[]>}
   * @throws {FileError} where the library has no index of the clip
   */
  async similar(id, stretch) {
    const rows = this.#hasIndex ? this.#said(() => this.db.selectObjects(SIGNATURES)) : [];
    const query = rows.findIndex(({ clip }) => clip === id);
    if (query < 0) {
      throw new FileError("has no index for search; 'mocapress library reindex' makes it", {
        file: this.#said(() => this.db.selectValue("SELECT name FROM clips WHERE id = ?", [id])),
      });
    }
    const record = (place) => {
      const asked = [rows[place].clip];
      return readRecord(this.#said(() => this.db.selectValue(FEATURES, asked)) ?? new Uint8Array());
    };
    const own = await record(query);
    const features = (place) => record(place).catch(() => NOTHING); // a damaged one is not found
    if (!stretch) {
      const signatures = rows.map(({ signature }) => new Int8Array(signature));
      const hits = await rank(query, signatures, features);
      return hits.map(({ place, score }) => {
        const { clip, frames, frameTime } = rows[place];
        return { id: clip, start: 0, seconds: [0, frames * frameTime], score };
      });
    }
    const [first, last] = stretch.map((frame) => frame * rows[query].frameTime * RATE);
    const begin = Math.min(Math.round(first), own.frames - 1);
    const end = Math.min(Math.max(Math.round(last), begin + 1), own.frames);
    async function* all() {
      for (const place of rows.keys()) yield [place, await features(place)];
    }
    return (await find(part(own, begin, end), all())).map(({ place, score, ...found }) => {
      const { clip, frames, frameTime } = rows[place];
      const seconds = [found.first / RATE, Math.min(found.last / RATE, frames * frameTime)];
      return { id: clip, start: Math.round(seconds[0] / frameTime), seconds, score };
    });
  }

  async #open(id) {
    const row = this.#said(() => this.db.selectObject(this.#clip, [id]));
    if (!row) throw new FileError("damaged: there is no such clip", { found: `id ${id}` });
    if (!row.head) throw new FileError("holds a file that is no motion", { file: row.name });
    if (this.#hasNeeds && this.#said(() => this.db.selectValue(NEEDS, [id]))) {
      throw new FileError(
        "is predicted from other clips of the library, which the page cannot decode on its own; " +
          "'mocapress view' of the library plays it",
        { file: row.name },
      );
    }
    return { name: row.name, mcz: await mczOfParts(row, this.assets) };
  }

  /** Give the pieces of a clip with their frames. */
  async *#decode(mcz, stream, id, models) {
    const rows = new Map();
    for (const piece of mcz.chunks[stream]) {
      const { source, first, frames, sourceFirst } = piece;
      if (!rows.has(source)) {
        const other = source === id ? { ...mcz, chunks: mcz.own } : (await this.#open(source)).mcz;
        rows.set(source, await ownRows(other, stream, models, this.assets));
      }
      const width = mcz.streams[stream].columns.length;
      const values = rows.get(source).subarray(sourceFirst * width, (sourceFirst + frames) * width);
      if (values.length !== frames * width) throw new FileError("damaged: a run of missing frames");
      yield { first, frames, values };
    }
  }

  /** An error of SQLite is the file's fault. */
  #said(ask) {
    try {
      return ask();
    } catch (error) {
      if (error.name !== "SQLite3Error") throw error;
      throw new FileError(`the library is damaged (${error.message})`);
    }
  }
}

/** All frames of a stream in pieces, as chunks: its own and those of its runs. */
function piecesOf(chunks, runs, stream, id) {
  const total = (list) => list.reduce((sum, { frames }) => sum + frames, 0);
  const mine = runs.filter((run) => run.stream === stream);
  const end = { first: total(chunks) + total(mine), frames: 0 };
  const pieces = [];
  let [reached, own] = [0, 0];
  for (const run of [...mine, end]) {
    const frames = run.first - reached;
    if (frames < 0) throw new FileError("damaged: the runs of other clips");
    if (frames) pieces.push({ first: reached, frames, source: id, sourceFirst: own });
    own += frames;
    if (run.frames) pieces.push(run);
    reached = run.first + run.frames;
  }
  return pieces;
}

/** The frames that a clip has in chunks of its own: F x C, row by row. */
async function ownRows(mcz, stream, models, assets) {
  const parts = [];
  for await (const { values } of decodeStream(mcz, stream, models, assets)) parts.push(values.slice());
  const rows = new Float64Array(parts.reduce((sum, part) => sum + part.length, 0));
  let at = 0;
  for (const part of parts) {
    rows.set(part, at);
    at += part.length;
  }
  return rows;
}
