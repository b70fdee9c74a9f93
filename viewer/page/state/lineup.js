import { nextUp, USUAL_HEIGHT } from "./bearings.js";
import { compare } from "./comparison.js";

/** Original blue, decoded green, then whoever else there is. */
export const COLOURS = ["#3f83f8", "#1fb57a", "#f59e0b", "#a37cf0", "#ef5f6b", "#12b5c9"];

/** Clips that are shown at once; more are turned over like pages. */
export const MOST_AT_ONCE = 16;

const ALIKE = 0.2; // mean distance of a decoded clip's joints, of the figure's size
const APART = 0.25; // distance of two performers' roots, of the figure's size

/**
 * The clips on the page: who stands where, in which colour, and how two of them differ.
 *
 * Several are shown in one of the `modes` that suit them: "compare" lays the second over the first and
 * colours its errors, "together" has all in one scene, where the files place them, "apart" gives each
 * a scene.
 */
export class Lineup {
  constructor() {
    this.all = [];
    this.takes = [];
    this.modes = ["apart"];
    this.mode = "apart";
    this.errorsShown = true;
    this.comparison = null;
    this.set([]);
  }

  /** @param {import("./take.js").Take[]} takes */
  set(takes) {
    this.all = takes;
    this.turnTo(0);
  }

  get pages() {
    return Math.ceil(this.all.length / MOST_AT_ONCE);
  }

  /** Show a page's clips. */
  turnTo(page) {
    this.page = Math.max(0, Math.min(page, this.pages - 1));
    this.takes = this.all.slice(this.page * MOST_AT_ONCE, (this.page + 1) * MOST_AT_ONCE);
    this.#consider();
  }

  /** Whether errors of the second clip are shown: where it is asked for, or plainly the first one decoded. */
  get isCompared() {
    return this.comparison !== null && (this.mode === "compare" || (this.mode === "apart" && this.alike));
  }

  get colours() {
    return this.takes.map((_, i) => COLOURS[i % COLOURS.length]);
  }

  /** Those with figures. */
  get figures() {
    return this.takes.filter((take) => take.points);
  }

  /** The longest clip's frames and frame time are the player's. */
  get longest() {
    return this.takes.reduce((a, b) => (b.seconds > a.seconds ? b : a));
  }

  get nextMode() {
    return this.modes[(this.modes.indexOf(this.mode) + 1) % this.modes.length];
  }

  changeMode() {
    this.mode = this.nextMode;
    this.#stand();
  }

  turnUp() {
    if (!this.takes.length) return;
    this.up = nextUp(this.takes[0].bearings.up);
    this.#stand();
  }

  /** Find the modes that suit the clips, and begin with the first that does. */
  #consider() {
    this.up = undefined;
    const { takes, figures } = this;
    const [original, decoded] = takes;
    this.comparison = takes.length === 2 ? compare(original, decoded) : null;
    if (takes.length === 2 && decoded.clip.frameTime === null)
      decoded.frameTime = original.frameTime;
    for (const take of takes) take.standUp();
    this.alike =
      this.comparison !== null &&
      this.comparison.average < (ALIKE * USUAL_HEIGHT) / original.bearings.scale;
    const fits = figures.length > 1 && !this.alike && figures.every((take) => isOfOneSpace(figures[0], take));
    this.modes = ["apart"];
    if (fits) this.modes.unshift("together");
    if (this.comparison) this.modes.unshift("compare");
    const scene = fits && isOneScene(figures);
    this.mode = this.alike ? "compare" : scene ? "together" : "apart";
    this.#stand();
  }

  /** Give all the bearings that the mode wants. */
  #stand() {
    const { takes, figures } = this;
    for (const take of takes) take.standUp(this.up);
    if (this.mode === "together") {
      const common = inCommon(figures);
      for (const take of figures) take.standAs(common);
    } else if (this.comparison && (this.mode === "compare" || this.alike)) {
      takes[1].standAs(takes[0].bearings);
    }
  }
}

function isOfOneSpace({ bearings: a }, { bearings: b }) {
  return a.up.join() === b.up.join() && Math.max(a.scale / b.scale, b.scale / a.scale) < 1.5;
}

/** Whether clips are of one time and place: as long as each other, and nobody stands in another. */
function isOneScene(takes) {
  const [first] = takes;
  const isAsLong = (take) =>
    take.frames === first.frames && Math.abs(take.frameTime / first.frameTime - 1) < 1e-3;
  if (!takes.every(isAsLong)) return false;
  for (const take of takes) take.standAs(first.bearings);
  return takes.every((take, i) =>
    takes.slice(0, i).every((other) => distance(take, other) > APART * USUAL_HEIGHT),
  );
}

/** Median distance of the roots of two takes that are as long as each other and stand alike. */
function distance(take, other) {
  const [a, b] = [[], []];
  const distances = Float64Array.from({ length: take.frames }, (_, frame) => {
    take.rootOnStage(frame, a);
    other.rootOnStage(frame, b);
    return Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
  }).sort();
  return distances[distances.length >> 1];
}

/** Bearings of the first, with a middle and a reach of all. */
function inCommon(takes) {
  const { bearings } = takes[0];
  const [low, high] = [[Infinity, Infinity], [-Infinity, -Infinity]];
  for (const take of takes) {
    take.standAs(bearings);
    take.way.forEach((value, i) => {
      low[i % 2] = Math.min(low[i % 2], value);
      high[i % 2] = Math.max(high[i % 2], value);
    });
  }
  const centre = [(low[0] + high[0]) / 2, 0, (low[1] + high[1]) / 2];
  return { ...bearings, centre, reach: Math.hypot(high[0] - low[0], high[1] - low[1]) / 2 };
}
