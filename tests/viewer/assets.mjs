// The page's binary files, for tests in Node.
import { readFileSync } from "node:fs";

import { Assets } from "../../viewer/mcz/assets.js";

const root = new URL("../../", import.meta.url);
const place = (path) =>
  path === "dictionary1.bin" ? `src/mocapress/container/${path}` : `viewer/${path}`;

export const assets = new Assets((path) => readFileSync(new URL(place(path), root)));
