import { nextUp } from "./bearings.js";
import { compare } from "./comparison.js";

/** Original blue, decoded green, then whoever else there is. */
export const COLOURS = ["#3f83f8", "#1fb57a", "#f59e0b", "#a37cf0", "#ef5f6b", "#12b5c9"];

/** The clips on the page: who stands where, in which colour, and how two of them differ. */
export class Lineup {
  constructor() {
    this.takes = [];
    this.overlaid = true;
    this.errorsShown = true;
    this.comparison = null;
  }

  /** @param {import("./take.js").Take[]} takes */
  set(takes) {
    this.takes = takes;
    const [original, decoded] = takes;
    this.comparison = takes.length === 2 ? compare(original, decoded) : null;
    if (this.comparison) decoded.standAs(original.bearings);
    if (takes.length === 2 && decoded.clip.frameTime === null)
      decoded.frameTime = original.frameTime;
  }

  get colours() {
    return this.takes.map((_, i) => COLOURS[i % COLOURS.length]);
  }

  /** Those with figures. */
  get figures() {
    return this.takes.filter((take) => take.points);
  }

  get isOverlaid() {
    return this.overlaid && this.comparison !== null;
  }

  /** The longest clip's frames and frame time are the player's. */
  get longest() {
    return this.takes.reduce((a, b) => (b.seconds > a.seconds ? b : a));
  }

  turnUp() {
    const up = this.takes.length ? nextUp(this.takes[0].bearings.up) : null;
    for (const take of this.takes) take.standUp(up);
    if (this.comparison) this.takes[1].standAs(this.takes[0].bearings);
  }
}
