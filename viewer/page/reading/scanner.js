import { FileError } from "./file_error.js";

const [TAB, NEWLINE, RETURN, SPACE, HASH] = [9, 10, 13, 32, 35];
const [PLUS, MINUS, POINT, ZERO] = [43, 45, 46, 48];
const NUMBER = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;
// Powers of ten that a double holds exactly: a quotient by one of them is rounded once.
const POWERS = Array.from({ length: 23 }, (_, k) => Number(`1e${k}`));

const isBlank = (byte) => byte === SPACE || byte === TAB || byte === RETURN;

/** Bytes as text, one character each; kept in parts, since a call takes a bounded list. */
export function latin1(bytes, begin = 0, end = bytes.length) {
  let text = "";
  for (let i = begin; i < end; i += 8192) {
    text += String.fromCharCode.apply(null, bytes.subarray(i, Math.min(end, i + 8192)));
  }
  return text;
}

/** Reads the rows of a motion file: words and numbers between blanks, line by line. */
export class Scanner {
  /**
   * @param {Uint8Array} bytes
   * @param {number} [position]
   */
  constructor(bytes, position = 0) {
    this.bytes = bytes;
    this.position = position;
  }

  /** Go to the next line that is neither empty nor a comment; false at the end of the file. */
  toContent() {
    const { bytes } = this;
    let at = this.position;
    while (at < bytes.length) {
      if (bytes[at] === HASH) {
        while (at < bytes.length && bytes[at] !== NEWLINE) at++;
      } else if (bytes[at] === NEWLINE || isBlank(bytes[at])) {
        at++;
      } else {
        break;
      }
    }
    this.position = at;
    return at < bytes.length;
  }

  /** Whether the line ends here; if so, skip it. */
  lineEnds() {
    this.#passBlanks();
    if (this.position < this.bytes.length && this.bytes[this.position] !== NEWLINE) return false;
    this.position++;
    return true;
  }

  /** The next word of this line, "" at its end. */
  word() {
    this.#passBlanks();
    const begin = this.position;
    this.position = this.#tokenEnd(begin);
    return latin1(this.bytes, begin, this.position);
  }

  /** Whether the next word is this one; if so, skip it. */
  passes(word) {
    this.#passBlanks();
    const { bytes, position } = this;
    const end = position + word.length;
    for (let k = 0; k < word.length; k++) {
      if (bytes[position + k] !== word.charCodeAt(k)) return false;
    }
    if (end < bytes.length && bytes[end] !== NEWLINE && !isBlank(bytes[end])) return false;
    this.position = end;
    return true;
  }

  /**
   * The next number of this line: the double nearest to its text. NaN where there is none; the
   * position then stays.
   */
  number() {
    this.#passBlanks();
    const { bytes } = this;
    const begin = this.position;
    let at = begin;
    const negative = bytes[at] === MINUS;
    if (negative || bytes[at] === PLUS) at++;
    let whole = 0;
    let digits = 0;
    let decimals = 0;
    let point = false;
    for (; at < bytes.length; at++) {
      const byte = bytes[at];
      if (byte >= ZERO && byte < ZERO + 10) {
        whole = 10 * whole + (byte - ZERO);
        digits++;
        if (point) decimals++;
      } else if (byte === POINT && !point) {
        point = true;
      } else {
        break;
      }
    }
    const ends = at >= bytes.length || bytes[at] === NEWLINE || isBlank(bytes[at]);
    if (ends && digits > 0 && digits < 16) {
      this.position = at;
      const value = whole / POWERS[decimals];
      return negative ? -value : value;
    }
    const text = latin1(bytes, begin, this.#tokenEnd(begin));
    const value = NUMBER.test(text) ? Number(text) : NaN;
    if (!Number.isFinite(value)) return NaN;
    this.position = begin + text.length;
    return value;
  }

  /** Skip the rest of this line. */
  toNextLine() {
    while (this.position < this.bytes.length && this.bytes[this.position] !== NEWLINE) {
      this.position++;
    }
    this.position++;
  }

  /** Whether a number could begin here. */
  startsNumber() {
    return "+-.0123456789".includes(String.fromCharCode(this.bytes[this.position]));
  }

  /** Whether nothing follows but what programs leave behind a text: NULs, or the Ctrl-Z of DOS. */
  onlyPadding() {
    for (let at = this.position; at < this.bytes.length; at++) {
      const byte = this.bytes[at];
      if (byte !== 0 && byte !== 26 && byte !== NEWLINE && !isBlank(byte)) return false;
    }
    return true;
  }

  /** What the page says of bytes behind the last row. */
  afterEnd() {
    const found = `${this.bytes.length - this.position} bytes`;
    const details = { line: this.line, expected: "the end of the file", found };
    return new FileError("bytes after the last frame", details).message;
  }

  /** Line number of the position, from 1. */
  get line() {
    let line = 1;
    const end = Math.min(this.position, this.bytes.length);
    for (let i = 0; i < end; i++) if (this.bytes[i] === NEWLINE) line++;
    return line;
  }

  /** What stands at the position, for a message. */
  get found() {
    this.#passBlanks();
    if (this.position >= this.bytes.length) return "the end of the file";
    const end = Math.min(this.#tokenEnd(this.position), this.position + 40);
    return end > this.position
      ? `'${latin1(this.bytes, this.position, end)}'`
      : "the end of the line";
  }

  #passBlanks() {
    while (isBlank(this.bytes[this.position])) this.position++;
  }

  #tokenEnd(begin) {
    let at = begin;
    while (at < this.bytes.length && this.bytes[at] !== NEWLINE && !isBlank(this.bytes[at])) at++;
    return at;
  }
}
