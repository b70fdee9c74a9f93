// A clip finds its place by itself: up axis, scale, floor, front; and its error against another.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";

import { readFiles } from "../../viewer/page/reading/files.js";
import { findBearings, turnUp } from "../../viewer/page/state/bearings.js";
import { compare } from "../../viewer/page/state/comparison.js";
import { placed as placedBy } from "../../viewer/page/work/placing.js";
import { assets } from "./assets.mjs";
import { Player } from "../../viewer/page/state/player.js";
import { Take } from "../../viewer/page/state/take.js";

const placed = (clip) => placedBy(clip, assets);

const UPS = [
  [0, 1],
  [1, 1],
  [2, 1],
  [0, -1],
  [1, -1],
  [2, -1],
];

// Hips, head, two feet and two hands; feet 100 units below the hips, facing +z when y is up.
const names = ["hips", "head", "leftFoot", "rightFoot", "leftHand", "rightHand"];
const places = [
  [0, 100, 0],
  [0, 180, 0],
  [10, 0, 0],
  [-10, 0, 0],
  [60, 140, 0],
  [-60, 140, 0],
];

/** The figure with another axis up; it walks along its front. */
function figure(up, step = 0) {
  const back = inverse(turnUp(up));
  const joints = names.map((name, i) => ({
    name,
    parent: i ? 0 : -1,
    offset: i ? back(...places[i].map((x, k) => x - places[0][k])) : [0, 0, 0],
    channels: i ? [] : ["tx", "ty", "tz"],
    axis: [0, 0, 0],
    axisOrder: "xyz",
    ends: [],
  }));
  const frames = 50;
  const way = Array.from({ length: frames }, (_, f) => back(0, 100, step * f));
  const channels = [0, 1, 2].map((k) => Float64Array.from(way, (place) => place[k]));
  const columns = [
    [0, "tx"],
    [0, "ty"],
    [0, "tz"],
  ];
  const skeleton = { rotation: "moving", angleUnit: "deg", lengthUnit: null, joints, columns };
  return { name: "figure", names: ["a", "b", "c"], frames, channels, skeleton, frameTime: 0.01 };
}

function inverse(turn) {
  const [a, b, c] = [turn(1, 0, 0), turn(0, 1, 0), turn(0, 0, 1)];
  return (x, y, z) => [a, b, c].map((column) => column[0] * x + column[1] * y + column[2] * z);
}

for (const up of UPS) {
  test(`a figure with axis ${up} up stands upright, on the floor, of a person's size`, async () => {
    const take = new Take(await placed(figure(up, 10)));
    assert.deepEqual(take.bearings.up, up);
    const place = [0, 0, 0];
    take.onStage(0, 1, place);
    assert.ok(Math.abs(place[1] - 1.7) < 1e-6, `head at ${place}`);
    take.onStage(0, 2, place);
    assert.ok(Math.abs(place[1]) < 1e-6, `foot at ${place}`);
    assert.ok(Math.abs(take.bearings.facing) < 1e-6);
    assert.ok(Math.abs(take.bearings.reach - (490 / 2) * (1.7 / 180)) < 1e-6);
  });
}

test("turning up keeps the hand", () => {
  for (const up of UPS) {
    const turn = turnUp(up);
    const [a, b, c] = [turn(1, 0, 0), turn(0, 1, 0), turn(0, 0, 1)];
    const cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    assert.deepEqual(
      cross.map((x) => x + 0),
      c.map((x) => x + 0),
    );
  }
});

test("without telling names the long way is up", () => {
  const positions = new Float32Array([0, 0, 0, 0, 0, 90, 5, 5, 180]);
  assert.deepEqual(findBearings(positions, 3, ["a", "b", "c"]).up, [2, 1]);
});

/** A take of one of tests/cases. */
async function take(name) {
  const place = new URL(`../cases/48-up-and-root/${name}`, import.meta.url);
  const { clips } = await readFiles([{ name, bytes: readFileSync(place) }], assets);
  return new Take(await placed(clips[0]));
}

test("who lies on the floor most of the time does not stand upside down", async () => {
  const { bearings } = await take("z_up_push_ups.bvh");
  assert.deepEqual(bearings.up, [2, 1]);
});

test("joints that stand still above the hips are no part of the figure", async () => {
  const made = await take("static_root_walk.bvh");
  assert.equal(made.jointNames[made.root], "Hips");
  assert.ok(made.bones.every(([parent]) => parent >= made.root));
  const place = [0, 0, 0];
  made.onStage(0, made.jointNames.indexOf("Neck"), place);
  assert.ok(Math.abs(place[1] - 1.6) < 0.15, `neck at ${place}`);
  made.rootOnStage(made.frames - 1, place);
  assert.ok(Math.abs(place[2] - made.bearings.scale * 956) < 0.01, `hips at ${place}`);
});

test("a chain of links that stand still is a figure", async () => {
  const clip = figure([1, 1]);
  clip.skeleton.joints.forEach((joint, i) => (joint.parent = i - 1));
  assert.equal(new Take(await placed(clip)).root, 0);
});

test("nothing and a single point have bearings, too", () => {
  assert.equal(findBearings(new Float32Array(0), 0, []).reach, 0);
  const { scale } = findBearings(new Float32Array([1, 2, 3]), 1, ["a"]);
  assert.ok(Number.isFinite(scale));
  assert.ok(Number.isFinite(findBearings(new Float32Array([NaN, 0, 0]), 1, ["a"]).scale));
});

test("errors are distances", async () => {
  const [a, b] = [figure([1, 1]), figure([1, 1])];
  b.channels[0] = b.channels[0].map((x, frame) => x + (frame === 7 ? 3 : 0));
  b.channels[2] = b.channels[2].map((x, frame) => x + (frame === 7 ? 4 : 0));
  const made = compare(new Take(await placed(a)), new Take(await placed(b)));
  assert.equal(made.largest, 5);
  assert.deepEqual(
    [...made.worst].filter((error) => error > 0),
    [5],
  );
  assert.equal(made.worst[7], 5);
  assert.ok(Math.abs(made.average - 5 / 50) < 1e-9);
  const other = figure([1, 1]);
  other.skeleton.joints[5].parent = 1;
  assert.equal(compare(new Take(await placed(a)), new Take(await placed(other))), null);
});

test("the player plays, steps and begins again", () => {
  const player = new Player();
  player.measure(10, 0.1);
  player.advance(1);
  assert.equal(player.frame, 0); // it pauses until it is started
  player.play();
  player.advance(0.25);
  assert.equal(player.frame, 2);
  player.setSpeed(2);
  player.advance(0.2);
  assert.equal(player.frame, 6);
  player.advance(0.2);
  assert.equal(player.frame, 0);
  player.step(-1);
  assert.deepEqual([player.frame, player.playing], [0, false]);
  player.step(100);
  assert.equal(player.frame, 9);
  for (let frame = 0; frame < 10; frame++) {
    player.seek(frame);
    assert.equal(player.frame, frame);
  }
});

test("a clip that no memory can hold is refused before anything is made", async () => {
  const clip = figure([1, 1]);
  await assert.rejects(
    placed({ ...clip, frames: 1e7 }),
    /too many frames and points.*found 10000000 x 6/,
  );
  const empty = await placed({ ...clip, frames: 0 });
  assert.throws(() => new Take(empty), /no frames/);
});
