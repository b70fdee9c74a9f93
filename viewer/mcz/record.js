import { MczError } from "./error.js";

const UTF8 = new TextDecoder("utf-8", { fatal: true, ignoreBOM: true });

/** Takes the fields of a record off, in order (docs/format.md, "Conventions"). */
export class Record {
  /**
   * @param {Uint8Array} bytes
   * @param {string} name for messages
   * @param {number} [begin] where the bytes begin in the file, where they are a piece of it
   */
  constructor(bytes, name, begin = 0) {
    this.bytes = bytes;
    this.name = name;
    this.begin = begin;
    this.at = 0;
  }

  fail(what) {
    return new MczError(`${this.name}: ${what}`, { offset: this.begin + this.at });
  }

  get left() {
    return this.bytes.length - this.at;
  }

  raw(count) {
    if (count > this.left) throw this.fail(`${count} bytes announced, ${this.left} left`);
    this.at += count;
    return this.bytes.subarray(this.at - count, this.at);
  }

  byte() {
    return this.raw(1)[0];
  }

  uint32() {
    const bytes = this.raw(4);
    return new DataView(bytes.buffer, bytes.byteOffset, 4).getUint32(0, true);
  }

  double() {
    const bytes = this.raw(8);
    return new DataView(bytes.buffer, bytes.byteOffset, 8).getFloat64(0, true);
  }

  /** An integer of at most so many bits, as a BigInt. */
  wide(bits = 63) {
    let value = 0n;
    for (let shift = 0; ; shift += 7) {
      if (shift > bits) throw this.fail("integer too long");
      const byte = this.byte();
      value |= BigInt(byte & 127) << BigInt(shift);
      if (byte < 128) break;
    }
    if (value >> BigInt(bits)) throw this.fail("integer too large");
    return value;
  }

  /** An integer of at most `most`. */
  integer(most = Number.MAX_SAFE_INTEGER) {
    let value = 0;
    for (let scale = 1; ; scale *= 128) {
      const byte = this.byte();
      value += (byte & 127) * scale;
      if (byte < 128) break;
      if (scale > most) throw this.fail("integer too long");
    }
    if (value > most) throw this.fail(`${value} where at most ${most} may stand`);
    return value;
  }

  signed() {
    const value = this.wide(64);
    return Number(value & 1n ? -(value >> 1n) - 1n : value >> 1n);
  }

  /** The number of records that follow, of at least so many bytes each. */
  count(leastBytes = 1) {
    return this.integer(Math.floor(this.left / leastBytes));
  }

  prefixed() {
    return this.raw(this.integer());
  }

  text() {
    const bytes = this.prefixed();
    try {
      return UTF8.decode(bytes);
    } catch {
      throw this.fail("not a text");
    }
  }

  list(count, take) {
    return Array.from({ length: count }, (_, index) => take(index));
  }

  /** A list in which equal neighbours stand together. */
  runs(count, take) {
    const values = [];
    while (values.length < count) {
      const value = take();
      const run = this.integer(count - values.length);
      if (run === 0) throw this.fail("an empty run");
      for (let i = 0; i < run; i++) values.push(value);
    }
    return values;
  }

  numbers(count) {
    const scale = 10 ** this.integer(15);
    if (count > this.left) throw this.fail(`${count} numbers announced`);
    return this.list(count, () => {
      const k = this.wide(55);
      if (k === 0n) return this.double();
      const magnitude = Number((k - 1n) >> 1n) / scale;
      return k & 1n ? magnitude : -magnitude;
    });
  }

  end() {
    if (this.left) throw this.fail(`${this.left} bytes too many`);
  }
}
