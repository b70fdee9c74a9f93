// Numbers are read as the nearest doubles, as JavaScript itself and Python read them.
import assert from "node:assert/strict";
import { test } from "node:test";

import { Scanner } from "../../viewer/page/reading/scanner.js";

const scanner = (text) => new Scanner(new TextEncoder().encode(text));

test("numbers in any usual notation", () => {
  const texts = [
    "0",
    "-0",
    "+1",
    "1.",
    ".5",
    "-.5",
    "1e3",
    "-1.6201e-014",
    "2.5E+2",
    "9007199254740993",
  ];
  const reader = scanner(`${texts.join(" ")}\n`);
  for (const text of texts) assert.ok(Object.is(reader.number(), Number(text)), text);
  assert.ok(reader.lineEnds());
});

test("decimals are rounded once", () => {
  let state = 1;
  for (let i = 0; i < 20000; i++) {
    state = (state * 48271) % 2147483647;
    const digits = 1 + (state % 17);
    const decimals = (state >> 5) % 19;
    const value = (state / 2147483647) * 10 ** (digits - decimals);
    const text = `${i % 2 ? "-" : ""}${value.toFixed(decimals)}`;
    assert.equal(scanner(text).number(), Number(text), text);
  }
});

test("what is no number stays where it is", () => {
  for (const text of ["x", "1x", "1-2", "--1", "1.2.3", ".", "e5", "nan", "inf", "1e999", "0x10"]) {
    const reader = scanner(`  ${text}`);
    assert.ok(Number.isNaN(reader.number()), text);
    assert.equal(reader.found, `'${text}'`);
  }
  assert.equal(scanner("  \n1").found, "the end of the line");
  assert.equal(scanner("  ").found, "the end of the file");
});

test("comments and empty lines are passed over", () => {
  const reader = scanner("# one\n\n \t\r\n  # two\n 7\r\n");
  assert.ok(reader.toContent());
  assert.equal(reader.line, 5);
  assert.equal(reader.number(), 7);
  assert.ok(reader.lineEnds());
  assert.ok(!reader.toContent());
});
