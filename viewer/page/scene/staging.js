import { Color } from "three";

import { Stage } from "./stage.js";

const [AMBER, RED] = [new Color("#ffb020"), new Color("#f0314f")];

/**
 * Build the stages of a lineup: one for all where they are compared or in one scene, else one each.
 *
 * @param {import("../state/lineup.js").Lineup} lineup
 */
export function stagesOf(lineup) {
  const { colours, takes, figures, mode } = lineup;
  const own = (take) => colours[takes.indexOf(take)];
  if (mode === "apart") return figures.map((take) => new Stage([take], [own(take)]));
  return [new Stage(figures, figures.map(own), mode === "compare")];
}

/** Colour the figures at a time, by error where the lineup says so, and mark the chosen joint. */
export function paint(lineup, stages, time, chosen, mark) {
  const { comparison, errorsShown, takes, isCompared } = lineup;
  for (const stage of stages) {
    stage.figures.forEach((figure, i) => {
      const decoded = isCompared && figure.take === takes[1] && errorsShown;
      const isFirst = figure.take === takes[0];
      const marked = isFirst || isCompared ? chosen : -1;
      const frame = figure.take.frameAt(time);
      const painter = decoded ? painterOf(comparison, frame) : painterOfGaps(figure.take, frame);
      figure.paint(painter, i === stage.figures.length - 1 || isFirst ? marked : -1, mark);
    });
  }
}

/** Markers that are missing are red. */
function painterOfGaps(take, frame) {
  if (!take.clip.markers) return null;
  return (point, colour) => {
    if (take.isMissing(frame, point)) colour.copy(RED);
  };
}

function painterOf({ errors, points, largest, frames }, frame) {
  if (largest === 0 || frame >= frames) return null;
  return (point, colour) => {
    const share = errors[frame * points + point] / largest;
    if (share < 0.5) colour.lerp(AMBER, 2 * share);
    else colour.copy(AMBER).lerp(RED, 2 * share - 1);
  };
}
