import { Color } from "three";

import { Stage } from "./stage.js";

const [AMBER, RED] = [new Color("#ffb020"), new Color("#f0314f")];

/**
 * Build the stages of a lineup: one for two takes that are overlaid, else one for each figure.
 *
 * @param {import("../state/lineup.js").Lineup} lineup
 */
export function stagesOf(lineup) {
  const { colours, takes } = lineup;
  if (lineup.isOverlaid) return [new Stage(takes, colours)];
  return lineup.figures.map((take) => new Stage([take], [colours[takes.indexOf(take)]]));
}

/** Colour the figures at a time, by error where the lineup says so, and mark the chosen joint. */
export function paint(lineup, stages, time, chosen, mark) {
  const { comparison, errorsShown, takes } = lineup;
  for (const stage of stages) {
    stage.figures.forEach((figure, i) => {
      const decoded = comparison && figure.take === takes[1] && errorsShown;
      const isFirst = figure.take === takes[0];
      const marked = isFirst || comparison ? chosen : -1;
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
