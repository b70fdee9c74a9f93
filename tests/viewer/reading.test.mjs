// AMC and ASF in all their forms; that values and places are Python's is checked by tests/viewer.
import assert from "node:assert/strict";
import { test } from "node:test";

import { parseAmc } from "../../viewer/page/reading/amc.js";
import { parseAsf } from "../../viewer/page/reading/asf.js";
import { readFiles } from "../../viewer/page/reading/files.js";

const bytes = (text) => new TextEncoder().encode(text);
const amc = (text, skeleton = null) => parseAmc(bytes(text), skeleton);
const rows = (clip) => clip.channels.map((channel) => [...channel]);

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

test("a skeleton hangs on its root", () => {
  const { joints, lengthUnit, angleUnit, rotation } = parseAsf(ASF);
  assert.deepEqual([lengthUnit, angleUnit, rotation], [0.45, "deg", "fixed"]);
  assert.deepEqual(
    joints.map((joint) => joint.name),
    ["root", "Hip", "knee"],
  );
  assert.deepEqual(
    joints.map((joint) => joint.parent),
    [-1, 0, 1],
  );
  assert.deepEqual(joints[2].offset, [0, 3, 0]); // only the direction of `direction` counts
  assert.deepEqual(joints[2].ends, [[4, 0, 0]]);
  assert.deepEqual(joints[1].channels, ["rx", "rz"]);
});

test("a bone that is left out keeps its values; order is free", () => {
  const clip = amc("1\na 1 2\nb 3\n2\nb 4\n3\nb 5\na 6 7\n");
  assert.deepEqual(rows(clip), [
    [1, 1, 6],
    [2, 2, 7],
    [3, 4, 5],
  ]);
  assert.deepEqual(clip.names, ["a.v1", "a.v2", "b.v1"]);
});

test("bones may repeat names, in one order", () => {
  assert.deepEqual(rows(amc("1\na 1\na 2\n2\na 3\na 4\n")), [
    [1, 3],
    [2, 4],
  ]);
  assert.throws(
    () => amc("1\na 1\na 2\n2\na 3\n3\na 5\na 6\n"),
    /line 6: .*expected bone a; found '3'/,
  );
});

test("a bone twice in one frame is an error", () => {
  assert.throws(() => amc("1\na 1\nb 2\n2\nb 3\nb 4\n"), /line 6: frame 2 cannot be read/);
});

test("channels are found by names without regard to case", () => {
  const clip = amc(":RADIANS\n1\nroot 0 0 0 0 0 0\nhip 1 2\n", parseAsf(ASF));
  assert.equal(clip.angleUnit, "rad");
  assert.deepEqual(clip.names.slice(6), ["Hip.rx", "Hip.rz"]);
  assert.throws(
    () => amc("1\nelbow 1\n", parseAsf(ASF)),
    /no bone elbow; expected root, Hip, knee/,
  );
  assert.throws(() => amc("1\nhip 1\n", parseAsf(ASF)), /values of bone hip; expected 2 .*found 1/);
});

test("broken skeletons name the line", () => {
  const broken = (from, to) => () => parseAsf(ASF.replace(from, to));
  assert.throws(
    broken("root hip", "root hop"),
    /line 27: hierarchy; expected the name of a bone; found 'hop'/,
  );
  assert.throws(broken("Hip knee", ""), /line 19: bone knee; expected a way to root/);
  assert.throws(broken("length 4", "length x"), /line 22: length; expected a number; found 'x'/);
  assert.throws(broken("dof rx rz", "dof rx rx"), /line 15: dof/);
  assert.throws(broken(/:root[^]*?:bone/, ":bone"), /no root/);
  assert.throws(broken(/ {2}end\n:hier/, ":hier"), /a bone without end/);
});

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
  for (let i = 0; i < 3000; i++) {
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
    /^long.amc: too many frames and channels; expected a product of at most 50000000/,
  );
  assert.match(made.errors[1], /^a.bvh: frames are missing; expected 999999999999 frames/);
  assert.match(made.errors[2], /^deep.diffma.json: /);
  assert.match(made.errors[3], /^nested.diffma.json: \$\.channels\[0\]: expected a string/);
});
