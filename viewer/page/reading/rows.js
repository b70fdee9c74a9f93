import { FileError } from "./file_error.js";

const MOST_VALUES = 5e7; // 400 MB; a frame that leaves all bones out costs its file two bytes

/** Rows of numbers as they are read; how many there will be is not believed beforehand. */
export class Rows {
  /** @param {number} columns */
  constructor(columns) {
    this.columns = columns;
    this.count = 0;
    this.values = new Float64Array(Math.min(64 * columns, MOST_VALUES));
  }

  /** Begin a row with the values of the one before, or zeros; gives its first index. */
  begin() {
    const first = this.count * this.columns;
    if (first + this.columns > MOST_VALUES) {
      throw new FileError("too many frames and channels", {
        expected: `a product of at most ${MOST_VALUES}`,
        found: `${this.count + 1} x ${this.columns}`,
      });
    }
    if (first + this.columns > this.values.length) {
      const larger = new Float64Array(Math.min(2 * this.values.length, MOST_VALUES));
      larger.set(this.values);
      this.values = larger;
    }
    if (this.count > 0) this.values.copyWithin(first, first - this.columns, first);
    this.count++;
    return first;
  }

  /** The columns, each (F,). */
  channels() {
    const { values, columns, count } = this;
    return Array.from({ length: columns }, (_, column) => {
      const channel = new Float64Array(count);
      for (let row = 0, at = column; row < count; row++, at += columns) channel[row] = values[at];
      return channel;
    });
  }
}
