// Files that are dropped together, broken ones among them; that values and places are those of the
// native core is checked by test_reading.py.
import assert from "node:assert/strict";
import { test } from "node:test";

import { readFiles as read } from "../../viewer/page/reading/files.js";
import { assets } from "./assets.mjs";

const bytes = (text) => new TextEncoder().encode(text);
const readFiles = (files) => read(files, assets);

const ASF = `:units
  length 0.45
  angle deg
:root
  order TX TY TZ RX RY RZ
  axis XYZ
  position 0 0 0
  orientation 0 0 0
:bonedata
  begin
    name Hip
    direction 0 2 0
    length 3
    axis 0 0 90 XYZ
    dof rx rz
    limits (-160 20)
           (-70 70)
  end
  begin
    name knee
    direction 1 0 0
    length 4
    axis 0 0 0 XYZ
  end
:hierarchy
  begin
    root hip
    Hip knee
  end
`;

test("of many dropped files each gives a clip or an error", async () => {
  const made = await readFiles([
    { name: "a.amc", bytes: bytes("1\nroot 0 0 0 0 0 0\nhip 1 2\n") },
    { name: "02_01.amc", bytes: bytes("1\nroot 0 0 0 0 0 0\n") },
    { name: "02.asf", bytes: bytes(ASF) },
    { name: "a.asf", bytes: bytes(ASF) },
    { name: "other.txt", bytes: bytes("") },
    { name: "a.diffma.json", bytes: bytes('{"__proto__":{"channels":[]}}') },
  ]);
  assert.deepEqual(
    made.clips.map((clip) => clip.name),
    ["a.amc", "02_01.amc"],
  );
  assert.ok(made.clips.every((clip) => clip.skeleton));
  assert.equal(made.errors.length, 2);
  assert.match(made.errors[0], /^other.txt: not a file that this page plays; expected .bvh/);
  assert.match(made.errors[1], /^a.diffma.json: \$.channels: expected an array; found nothing/);
});

test("damaged files give errors, no other exceptions, and end", async () => {
  const source = bytes(`1\nroot 1 2 3 4 5 6\nhip 1 2\n2\nroot 1 2 3 4 5 6\nhip 1 2\n`);
  let state = 7;
  const random = (below) => (state = (state * 48271) % 2147483647) % below;
  for (let i = 0; i < 1000; i++) {
    const amcBytes = source.slice(0, random(2) ? source.length : random(source.length));
    const asfBytes = bytes(ASF).slice(0, random(2) ? ASF.length : random(ASF.length));
    for (const damaged of [amcBytes, asfBytes]) {
      if (damaged.length) damaged[random(damaged.length)] = random(256);
    }
    const { clips, errors } = await readFiles([
      { name: "a.amc", bytes: amcBytes },
      { name: "a.asf", bytes: asfBytes },
    ]);
    assert.equal(clips.length + errors.length, 1);
  }
});

test("what a file claims is not believed", async () => {
  const bones = Array.from({ length: 1000 }, (_, i) => `b${i} 1`).join("\n");
  const frames = Array.from({ length: 60000 }, (_, i) => i + 2).join("\n");
  const made = await readFiles([
    { name: "long.amc", bytes: bytes(`1\n${bones}\n${frames}\n`) },
    {
      name: "a.bvh",
      bytes: bytes(
        "HIERARCHY\nROOT a {\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n}\nMOTION\nFrames: 999999999999\nFrame Time: 1\n0\n",
      ),
    },
    { name: "deep.diffma.json", bytes: bytes("[".repeat(1e6)) },
    {
      name: "nested.diffma.json",
      bytes: bytes(`{"channels":${"[".repeat(1e4)}${"]".repeat(1e4)}}`),
    },
  ]);
  assert.equal(made.clips.length, 0);
  assert.match(
    made.errors[0],
    /^long.amc: more frames and channels than a file of this size may have; expected a product/,
  );
  assert.match(made.errors[1], /^a.bvh: frames are missing; expected 999999999999 frames/);
  assert.match(made.errors[2], /^deep.diffma.json: /);
  assert.match(made.errors[3], /^nested.diffma.json: \$\.channels\[0\]: expected a string/);
});
