/** What is wrong with a file: where, what was expected and what was found. */
export class FileError extends Error {
  /**
   * @param {string} what one sentence without the place
   * @param {{file?: string, line?: number, expected?: string, found?: string}} [details]
   */
  constructor(what, details = {}) {
    const { file, line, expected, found } = details;
    const place = [file, line && `line ${line}`].filter(Boolean).join(", ");
    let text = place ? `${place}: ${what}` : what;
    if (expected !== undefined) text += `; expected ${expected}`;
    if (found !== undefined) text += `; found ${found}`;
    super(text);
    this.name = "FileError";
    this.what = what;
    this.details = details;
  }

  /** The same error, of a file. */
  of(file) {
    return this.details.file ? this : new FileError(this.what, { ...this.details, file });
  }
}

/** Text from a file, short enough to be shown. */
export function quoted(text) {
  const line = text.split("\n")[0].trim();
  return line ? `'${line.slice(0, 40)}'` : "the end of the line";
}
