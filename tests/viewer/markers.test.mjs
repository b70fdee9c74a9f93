// Bones between markers: whatever a laboratory calls them, and none that run past a joint.
import assert from "node:assert/strict";
import { test } from "node:test";

import { bonesOf } from "../../viewer/page/reading/marker_sets.js";

const sides = (names, label) =>
  ["L", "R"].flatMap((side) => names.split(",").map((name) => label(side, name)));
const PLUG_IN = sides("ASI,THI,KNE,TIB,ANK,HEE,TOE", (side, name) => side + name);

for (const [kind, labels] of Object.entries({
  "behind a subject": PLUG_IN.map((label) => `Subject:${label}`),
  "with points": sides("ASIS,TH1,Knee,SH1,Ankle,Heel,Toe", (side, name) => `${side}.${name}`),
  "with strokes": sides("ASIS,Thigh_Front,Knee_Lat,Shank_Front,Ankle_Lat,Heel,MT_1", (side, name) => `${side}_${name}`),
  "in small letters": sides("asis,thigh,knee,shank,mall,heel,met", (side, name) => `${side.toLowerCase()} ${name}`),
  "with the side behind": sides("asis,thigh,knee,shank,ankle,heel,toe", (side, name) => `${name}_${side.toLowerCase()}`),
})) {
  test(`bones between names ${kind}`, () => assert.deepEqual(bonesOf(labels), bonesOf(PLUG_IN)));
}

test("a bone goes on past a wand and not past a joint", () => {
  const bones = (left) =>
    bonesOf(PLUG_IN.map((label) => (left.includes(label.slice(1)) ? `other ${label}` : label))).map((pair) =>
      pair.map((i) => PLUG_IN[i]).join("-"),
    );
  assert.ok(bones(["THI"]).includes("LASI-LKNE"));
  assert.ok(!bones(["KNE"]).some((bone) => /THI-.TIB|ASI-.TIB/.test(bone)));
});

test("names that say nothing have no bones", () => {
  assert.deepEqual(bonesOf(Array.from({ length: 40 }, (_, i) => `*${i}`)), []);
});
