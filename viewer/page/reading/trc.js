import { FileError, quoted } from "./file_error.js";
import { markerClip } from "./markers.js";

const BEFORE = 2; // columns before the markers: the frame's number and the time
const MOST_NUMBERS = 5e7; // 400 MB
const [NUMBERS, SAME, TEXTS, SERIES] = [0, 1, 2, 3]; // kinds of columns: docs/format/table.md

/**
 * Read a TRC file.
 *
 * @param {Uint8Array} bytes
 * @returns {import("./clip.js").Clip}
 * @throws {FileError} where there are no markers in it, or rows are missing
 */
export function readTrc(bytes) {
  const lines = textOf(bytes).split(/\r\n?|\n/);
  const named = lines.findIndex((line) => bare(line).startsWith("Frame"));
  if (named < 0) throw new FileError("no line of labels", { expected: "one that begins with Frame#" });
  const delimiter = /^"?Frame[^\t,;]*([\t,;])/.exec(lines[named].trimStart())?.[1] ?? "\t";
  const rows = lines
    .slice(named + 1)
    .map((line) => line.split(delimiter))
    .filter(([first]) => first.trim() && Number.isFinite(Number(first)));
  const facts = factsOf(lines.slice(0, named), delimiter);
  const announced = Number(facts.get("NumFrames") ?? NaN);
  if (rows.length < announced) {
    throw new FileError("fewer rows than declared", {
      expected: String(announced),
      found: String(rows.length),
    });
  }
  if (!rows.length) throw new FileError("no rows of numbers");
  const width = Math.max(...rows.slice(-32).map((row) => row.length));
  if (rows.length * width > MOST_NUMBERS) throw new FileError("too many rows and columns");
  const columns = Array.from({ length: width - BEFORE }, () => new Float64Array(rows.length));
  rows.forEach((row, i) => {
    if (row.length !== width) {
      throw new FileError("a row of another length", {
        expected: `${width} cells`,
        found: `${row.length}, ${quoted(row.join(" "))}`,
      });
    }
    columns.forEach((column, place) => (column[i] = numberOf(pointed(row[place + BEFORE]))));
  });
  return clipOf(lines[named], facts, delimiter, columns, rows.length);
}

/**
 * The clip of a TRC that is in a .mcz.
 *
 * @param {import("../../mcz/record.js").Record} record its layout: docs/format/table.md
 * @param {Float64Array[]} channels of the stream
 */
export function describedTrc(record, channels) {
  const [header, delimiter] = [record.prefixed(), record.prefixed()].map(textOf);
  record.prefixed(); // line break
  record.prefixed(); // tail
  const rows = record.integer();
  for (let left = record.count(2); left; left--) {
    record.integer();
    record.prefixed();
  }
  const kinds = record.list(record.count(), () => record.integer(SERIES));
  const stored = channels.values();
  const columns = kinds.map((kind) => {
    const text = kind === SAME || kind === TEXTS ? textOf(record.prefixed()) : "";
    if (kind === NUMBERS || kind === SERIES) {
      record.raw(4);
      record.integer();
      record.prefixed();
    }
    if (kind === SERIES) {
      for (let i = 0; i < 2; i++) {
        record.wide(64);
        record.wide();
      }
    }
    for (let left = record.count(2); left; left--) {
      record.integer();
      record.prefixed();
    }
    if (kind === NUMBERS) return stored.next().value;
    return new Float64Array(rows).fill(kind === SAME ? numberOf(text) : NaN);
  });
  const lines = header.split(/\r\n?|\n/);
  const named = lines.findLast((line) => bare(line).startsWith("Frame")) ?? "";
  const frames = channels[0]?.length ?? rows;
  return clipOf(named, factsOf(lines, delimiter), delimiter, columns.slice(BEFORE), frames);
}

function clipOf(line, facts, delimiter, columns, frames) {
  const labels = line.split(delimiter).slice(BEFORE).map(bare).filter(Boolean);
  const count = Math.min(labels.length, Math.floor(columns.length / 3));
  if (!count) throw new FileError("no markers in the table", { expected: "three columns for each" });
  const rate = Number(pointed(facts.get("DataRate") ?? "NaN"));
  return markerClip({
    labels: labels.slice(0, count),
    unit: facts.get("Units") ?? "",
    places: columns.slice(0, 3 * count),
    frames,
    frameTime: rate > 0 ? 1 / rate : null,
  });
}

/** What the header says: names in one line, values in the next. */
function factsOf(lines, delimiter) {
  const at = lines.findIndex((line) => bare(line.split(delimiter)[0]) === "DataRate");
  if (at < 0) return new Map();
  const values = (lines[at + 1] ?? "").split(delimiter).map(bare);
  return new Map(lines[at].split(delimiter).map((name, i) => [bare(name), values[i] ?? ""]));
}

function numberOf(cell) {
  return cell.trim() ? Number(cell) : NaN;
}

/** With a decimal point where there is a comma. */
function pointed(cell) {
  return cell.replace(",", ".");
}

function bare(cell) {
  return cell.trim().replace(/^"|"$/g, "");
}

function textOf(bytes) {
  const mark = bytes.length > 1 ? bytes[0] * 256 + bytes[1] : 0;
  if (mark === 0xfffe || mark === 0xfeff) {
    return new TextDecoder(mark === 0xfffe ? "utf-16le" : "utf-16be").decode(bytes);
  }
  try {
    return new TextDecoder("utf-8", { fatal: true }).decode(bytes);
  } catch {
    return new TextDecoder("latin1").decode(bytes);
  }
}
