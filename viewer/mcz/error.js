/** A file that is damaged, or that this reader cannot play: what is wrong, where, and why. */
export class MczError extends Error {
  /**
   * @param {string} what
   * @param {{offset?: number, expected?: string|number, found?: string|number}} [details]
   */
  constructor(what, { offset, expected, found } = {}) {
    let text = offset === undefined ? what : `byte ${offset}: ${what}`;
    if (expected !== undefined) text += `; expected ${expected}`;
    if (found !== undefined) text += `; found ${found}`;
    super(text);
    this.name = "MczError";
  }
}
