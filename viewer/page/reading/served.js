/** The library that the page's server offers. */
export class ServedLibrary {
  /**
   * @param {string} name
   * @param {import("../work/reader.js").Reader} reader
   */
  constructor(name, reader) {
    this.name = name;
    this.reader = reader;
  }

  /** @returns {Promise<{clips: import("../panels/library.js").StoredClip[], errors: string[]}>} */
  async catalogue() {
    const { response, errors } = await ask("catalogue");
    return response ? { clips: (await response.json()).clips, errors } : { clips: [], errors };
  }

  /**
   * @param {import("../panels/library.js").StoredClip} clip
   * @param {function(import("../work/reader.js").Read): void} begun as of `Reader.files`
   * @returns {Promise<import("../work/reader.js").Read>}
   */
  async read({ id, name }, begun) {
    const { response, errors } = await ask(`clips/${id}`);
    if (!response) return { clips: [], errors: errors.map((error) => `${name}: ${error}`) };
    const named = (read) => ({ ...read, clips: read.clips.map((clip) => ({ ...clip, name })) });
    const file = { name: `${name}.mcz`, bytes: new Uint8Array(await response.arrayBuffer()) };
    return named(await this.reader.files([file], (read) => begun(named(read))));
  }

  /**
   * Find what is like a clip, or like a stretch of it.
   *
   * @param {import("../panels/library.js").StoredClip} clip
   * @param {[number, number]|null} stretch the first frame, and the one behind the last
   * @returns {Promise<{hits: import("../panels/library.js").Hit[], errors: string[]}>}
   */
  async similar({ id }, stretch) {
    const { response, errors } = await ask(`similar/${id}${stretch ? `/${stretch.join("-")}` : ""}`);
    return { hits: response ? (await response.json()).hits : [], errors };
  }
}

/** Ask the server; an error is what it says, or that it is gone. */
export async function ask(path) {
  let response;
  try {
    response = await fetch(path);
  } catch {
    return { errors: ["`mocapress view` has ended, which serves this page"] };
  }
  return response.ok ? { response, errors: [] } : { errors: [await response.text()] };
}
