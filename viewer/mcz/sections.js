import { crc32 } from "./crc32.js";
import { MczError } from "./error.js";
import { Record } from "./record.js";

export const TAG = { head: 1, file: 2, chunk: 3, end: 4, notes: 0x81, companion: 0x82 };
const MAY_BE_SKIPPED = 0x80;
const CHECKSUM = 4;
const BEGIN = 5;
const NAMES = new Map(Object.entries(TAG).map(([name, tag]) => [tag, name]));

/**
 * Take a file apart into its sections and check their order and checksums.
 *
 * @param {Uint8Array} bytes
 * @param {string} magic its first four bytes
 * @returns {{sections: {tag: number, begin: number, end: number, content: Record}[], closed: boolean}}
 *     not closed: there is no end section, and what was cut off at the end is left out
 * @throws {MczError}
 */
export function readSections(bytes, magic = "\x89MCZ") {
  const found = String.fromCharCode(...bytes.subarray(0, 4));
  if (found !== magic) throw new MczError(`not a .${magic.slice(1).toLowerCase()} file`, { offset: 0 });
  if (bytes[4] !== 1) {
    throw new MczError("version of the file", { offset: 4, expected: 1, found: bytes[4] ?? "nothing" });
  }
  const file = new Record(bytes, "file");
  file.at = BEGIN;
  const sections = [];
  while (file.left) {
    const section = nextSection(file);
    if (!section) return { sections, closed: false };
    sections.push(section);
    if (magic === "\x89MCZ") checkPlace(section, sections);
    if (section.tag === TAG.end) {
      if (file.left) throw new MczError("bytes behind the end of the file", { offset: section.end });
      return { sections, closed: true };
    }
  }
  return { sections, closed: false };
}

/**
 * Sections that stand one behind the other, without what makes them a file.
 *
 * @throws {MczError} where one is cut off or has a wrong checksum
 */
export function sectionsOf(bytes) {
  const sections = [];
  for (const record = new Record(bytes, "chunks"); record.left; ) {
    const section = nextSection(record);
    if (!section) throw record.fail("a section that is cut off, or has a wrong checksum");
    sections.push(section);
  }
  return sections;
}

/** A section, or null where what is left is one that was cut off. */
function nextSection(file) {
  const { bytes, at: begin } = file;
  let tag, content, stored;
  try {
    tag = file.byte();
    content = file.prefixed();
    stored = file.uint32();
  } catch (error) {
    if (error instanceof MczError) return null;
    throw error;
  }
  if (crc32(bytes.subarray(begin, file.at - CHECKSUM)) !== stored) {
    if (!file.left || bytes.subarray(begin).every((byte) => byte === 0)) return null;
    throw new MczError(`section ${nameOf(tag)}: wrong checksum`, { offset: begin });
  }
  const start = content.byteOffset - bytes.byteOffset;
  return { tag, begin, end: file.at, content: new Record(content, nameOf(tag), start) };
}

function checkPlace({ tag, begin }, sections) {
  const fail = (what) => new MczError(`${what} section ${nameOf(tag)}`, { offset: begin });
  const before = sections.slice(0, -1);
  const has = (other) => before.some((section) => section.tag === other);
  if (NAMES.has(tag) && tag !== TAG.chunk && tag !== TAG.companion && has(tag)) throw fail("a second");
  if (tag & MAY_BE_SKIPPED || tag === TAG.chunk || tag === TAG.end) return;
  if (!NAMES.has(tag)) throw fail("this page does not know the");
  if (has(TAG.chunk) || (tag === TAG.head && has(TAG.file))) throw fail("in the wrong place:");
}

function nameOf(tag) {
  return NAMES.get(tag) ?? tag.toString(16).padStart(2, "0");
}
