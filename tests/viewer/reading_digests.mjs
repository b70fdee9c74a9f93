// What the page makes of files, for tests in Node and in a browser: names and digests of the values
// and of the places of all points.

/** SHA-256 of arrays of numbers, one behind the other, as text. */
async function digestOf(arrays) {
  const all = await new Blob(arrays).arrayBuffer();
  const bytes = new Uint8Array(await crypto.subtle.digest("SHA-256", all));
  return Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
}

/**
 * @param {{readFiles: Function, placesOf: Function}} page
 * @param {{name: string, bytes: Uint8Array}[]} files dropped at once
 */
export async function digests({ readFiles, placesOf }, files, assets) {
  const { clips, errors } = await readFiles(files, assets);
  const made = [];
  for (const clip of clips) {
    const places = [];
    let error;
    try {
      if (clip.skeleton) {
        for await (const some of placesOf(clip, assets)) places.push(some.places.slice());
      }
    } catch (caught) {
      error = caught.message;
    }
    made.push({
      names: clip.names,
      frames: clip.frames,
      frameTime: clip.frameTime,
      values: await digestOf(clip.channels),
      positions: clip.skeleton && !error ? await digestOf(places) : null,
      error,
      notes: clip.notes,
    });
  }
  return { clips: made, errors };
}
