// What the decoder keeps: the paper's listing, the vectors that Python decodes as well, and errors that
// name the place.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";

import { decode, DiffmaError } from "../../viewer/diffma/diffma.js";

const listing2 = () => ({
  channels: ["x0", "x1", "x2"],
  records: { b: ["2222", "1ZZZ", "1ZYa"], t: [[1], [0, 1], [0, 0.0952]] },
  params: {
    bits: 6,
    window: 64,
    bound: 2,
    class: "DiffMA",
    tolerance: 10,
    roundOffset: 0,
    encoding: "base85",
  },
});

const vectors = JSON.parse(readFileSync(new URL("diffma_vectors.json", import.meta.url), "utf8"));

// Listing 2 with one thing wrong, and the path at which that is found.
function broken(change) {
  const document = listing2();
  change(document);
  return document;
}

function fails(source, path, message) {
  assert.throws(
    () => decode(source),
    (error) => {
      assert.ok(error instanceof DiffmaError, `${error}`);
      assert.equal(error.path, path);
      assert.ok(error.message.startsWith(`${path}: expected `), error.message);
      if (message) assert.match(error.message, message);
      return true;
    },
  );
}

test("Listing 2 gives Listing 1", () => {
  const clip = decode(JSON.stringify(listing2()));
  assert.deepEqual(clip.names, ["x0", "x1", "x2"]);
  assert.equal(clip.frames, 5);
  assert.deepEqual([...clip.channels[0]], [1, 1, 1, 1, 1]);
  assert.deepEqual([...clip.channels[1]], [0, 1, 2, 3, 4]);
  assert.deepEqual([...clip.channels[2]].slice(0, 3), [0, 0.0952, 0.1904]);
  assert.ok(Math.abs(clip.channels[2][4] - 0.380799) < 0.0952 / 32);
});

for (const { name, document, bound, values } of vectors) {
  test(`${name}: the same values as in Python`, () => {
    const clip = decode(document, { bound });
    assert.deepEqual(
      clip.channels.map((channel) => [...channel]),
      values,
    );
  });
}

test("an empty document has no frames", () => {
  const none = { channels: [], records: { b: [], t: [] }, params: { bits: 6, window: 64, bound: 4 } };
  assert.equal(decode(none).frames, 0);
  assert.equal(decode(broken((d) => (d.records = { b: ["", "", ""], t: [[], [], []] }))).frames, 0);
  assert.equal(decode(broken((d) => (d.records = { b: ["", "", ""], t: [[1], [2], [3]] }))).frames, 1);
});

test("a broken document names the place", () => {
  fails("", "$");
  fails("[1", "$");
  fails("null", "$", /found null/);
  fails(undefined, "$");
  fails("[]", "$");
  fails("{}", "$.channels");
  fails(broken((d) => (d.channels[1] = 7)), "$.channels[1]", /a string; found 7/);
  fails(broken((d) => d.channels.pop()), "$.records.b", /2 items; found 3/);
  fails(broken((d) => delete d.records), "$.records");
  fails(broken((d) => (d.records.b = "2222")), "$.records.b", /an array/);
  fails(broken((d) => (d.records.b[1] = null)), "$.records.b[1]");
  fails(broken((d) => (d.records.b[2] = "1ZY")), "$.records.b[2]", /5 frames.*found 4/);
  fails(broken((d) => (d.records.b[2] = '1Z"a')), "$.records.b[2]", /RFC 1924.*at 2/);
  fails(broken((d) => (d.records.b[2] = "1Zéa")), "$.records.b[2]");
  fails(broken((d) => (d.records.b[2] = "1Z~a")), "$.records.b[2]", /opcodes of 6 bits/);
  fails(broken((d) => (d.records.t[0] = [])), "$.records.t[0]", /1 numbers.*found 0/);
  fails(broken((d) => d.records.t[2].push(1)), "$.records.t[2]", /2 numbers.*found 3/);
  fails(broken((d) => (d.records.t[2][1] = "0")), "$.records.t[2][1]");
  fails(broken((d) => (d.records.t[2][1] = NaN)), "$.records.t[2][1]", /NaN/);
  fails(JSON.stringify(listing2()).replace("0.0952", "1e999"), "$.records.t[2][1]", /Infinity/);
  fails(broken((d) => (d.records.t[1] = [-1.5e308, 1.5e308])), "$.records.b[1]", /finite values/);
});

test("wrong params name the place", () => {
  for (const [key, value] of [
    ["bits", 0],
    ["bits", 13],
    ["bits", 6.5],
    ["bits", "6"],
    ["window", 0],
    ["window", 2 ** 40],
    ["bound", 0],
    ["bound", -1],
    ["bound", Infinity],
    ["bound", undefined],
    ["order", 8],
    ["tolerance", 0],
    ["roundOffset", 2],
    ["encoding", "base64"],
    ["encoding", "base85x2"],
    ["class", "Other"],
  ]) {
    fails(broken((d) => (d.params[key] = value)), `$.params.${key}`);
  }
  fails(broken((d) => (d.params.bound = [1, 2])), "$.params.bound", /3 items/);
  fails(broken((d) => (d.params.bound = [1, 2, 0])), "$.params.bound[2]");
  fails(broken((d) => (d.params.order = [0, 0.5, 0])), "$.params.order[1]");
});

test("a wrong skeleton names the place", () => {
  const good = () => ({
    rotation: "fixed",
    joints: [
      { name: "root", parent: -1, offset: [0, 0, 0], channels: ["tx", "rx"] },
      { name: "hip", parent: 0, offset: [0, 1, 0], channels: ["rz"] },
    ],
    columns: [
      [0, "tx"],
      [0, "rx"],
      [1, "rz"],
    ],
  });
  const clip = decode(broken((d) => (d.skeleton = good())));
  assert.equal(clip.skeleton.joints[1].name, "hip");
  assert.deepEqual(clip.skeleton.joints[1].axis, [0, 0, 0]);
  const cases = [
    [(s) => (s.joints[1].parent = 1), "$.skeleton.joints[1].parent"],
    [(s) => (s.joints[1].offset = [0, 1]), "$.skeleton.joints[1].offset"],
    [(s) => (s.joints[1].offset[2] = "x"), "$.skeleton.joints[1].offset[2]"],
    [(s) => (s.joints[0].channels[1] = "qx"), "$.skeleton.joints[0].channels[1]"],
    [(s) => (s.joints[0] = null), "$.skeleton.joints[0]"],
    [(s) => (s.rotation = "free"), "$.skeleton.rotation"],
    [(s) => s.columns.pop(), "$.skeleton.columns"],
    [(s) => (s.columns[2][0] = 2), "$.skeleton.columns[2][0]"],
  ];
  for (const [change, path] of cases) {
    const skeleton = good();
    change(skeleton);
    fails(broken((d) => (d.skeleton = skeleton)), path);
  }
  fails(broken((d) => (d.frameTime = -1)), "$.frameTime");
  fails(broken((d) => (d.layout = 3)), "$.layout");
});

test("names and keys are data only", () => {
  const text = JSON.stringify(listing2())
    .replace('"x0"', '"__proto__"')
    .replace('"x1"', '"<img src=x onerror=alert(1)>"')
    .replace('{"channels"', '{"__proto__":{"polluted":1},"constructor":{},"channels"');
  const clip = decode(text);
  assert.deepEqual(clip.names.slice(0, 2), ["__proto__", "<img src=x onerror=alert(1)>"]);
  assert.equal({}.polluted, undefined);
  assert.equal(clip.polluted, undefined);
  // What only a prototype has is not there.
  fails(Object.create(listing2()), "$.channels");
});

test("deep nesting and size cost no more than reading them", () => {
  const deep = `${"[".repeat(200_000)}${"]".repeat(200_000)}`;
  fails(deep, "$");
  const inside = JSON.stringify(listing2()).replace('{"channels"', `{"more":${deep},"channels"`);
  try {
    assert.equal(decode(inside).frames, 5);
  } catch (error) {
    assert.ok(error instanceof DiffmaError);
  }
  const long = broken((d) => (d.records.b[0] = "2".repeat(5_000_000)));
  fails(long, "$.records.b[1]", /5000001 frames/);
});

test("every truncation is an error", () => {
  const text = JSON.stringify(listing2());
  for (let length = 0; length < text.length; length++) fails(text.slice(0, length), "$");
});
