import { Color } from "three";

import { nextUp } from "./bearings.js";
import { compare } from "./comparison.js";
import { Stage } from "./stage.js";

/** Original blue, decoded green, then whoever else there is. */
export const COLOURS = ["#3f83f8", "#1fb57a", "#f59e0b", "#a37cf0", "#ef5f6b", "#12b5c9"];
const [AMBER, RED] = [new Color("#ffb020"), new Color("#f0314f")];

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

  /** Build the stages: one for two that are laid over each other, else one each. */
  stages() {
    const { colours } = this;
    if (this.isOverlaid) return [new Stage(this.takes, colours)];
    return this.figures.map((take) => new Stage([take], [colours[this.takes.indexOf(take)]]));
  }

  turnUp() {
    const up = this.takes.length ? nextUp(this.takes[0].bearings.up) : null;
    for (const take of this.takes) take.standUp(up);
    if (this.comparison) this.takes[1].standAs(this.takes[0].bearings);
  }

  /** Colour the figures: by error, where that is wanted; mark the chosen joint. */
  paint(stages, time, chosen, mark) {
    for (const stage of stages) {
      stage.figures.forEach((figure, i) => {
        const decoded = this.comparison && figure.take === this.takes[1] && this.errorsShown;
        const isFirst = figure.take === this.takes[0];
        const marked = isFirst || this.comparison ? chosen : -1;
        const painter = decoded ? this.#painter(figure.take.frameAt(time)) : null;
        figure.paint(painter, i === stage.figures.length - 1 || isFirst ? marked : -1, mark);
      });
    }
  }

  #painter(frame) {
    const { errors, points, largest, frames } = this.comparison;
    if (largest === 0 || frame >= frames) return null;
    return (point, colour) => {
      const share = errors[frame * points + point] / largest;
      if (share < 0.5) colour.lerp(AMBER, 2 * share);
      else colour.copy(AMBER).lerp(RED, 2 * share - 1);
    };
  }
}
