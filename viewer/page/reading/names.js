/** Words of a line: between the blanks of ASCII, for bytes of UTF-8 may look like other blanks. */
export function words(line) {
  return line.split(/[ \t\r\n\v\f]+/).filter(Boolean);
}

/**
 * A joint's name from its bytes in a file, one character each: UTF-8 where it is that, else
 * Latin-1; %20 is a blank, as mocapress writes it, and %. is nothing.
 */
export function decodedName(raw) {
  const name = raw.replace(/%(?:([0-9A-F]{2})|\.\d*)/g, (_, hex) =>
    hex ? String.fromCharCode(parseInt(hex, 16)) : "",
  );
  const bytes = Uint8Array.from(name, (character) => character.charCodeAt(0));
  try {
    return new TextDecoder("utf-8", { fatal: true, ignoreBOM: true }).decode(bytes);
  } catch {
    return name;
  }
}
