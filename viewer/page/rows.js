/** Rows of numbers as they are read; how many there will be is not believed beforehand. */
export class Rows {
  /** @param {number} columns */
  constructor(columns) {
    this.columns = columns;
    this.count = 0;
    this.values = new Float64Array(64 * columns);
  }

  /** Begin a row with the values of the one before, or zeros; gives its first index. */
  begin() {
    const first = this.count * this.columns;
    if (first + this.columns > this.values.length) {
      const larger = new Float64Array(2 * this.values.length);
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
