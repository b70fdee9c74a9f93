import { axisName } from "../state/bearings.js";
import { element } from "./element.js";

const MOST_NAMES = 4; // at the top; the cells of a grid have names, too

/** What stands at the top: each clip's colour, name, length and rate. */
export function legend(lineup) {
  const count = lineup.takes.length;
  if (count > MOST_NAMES) {
    return [element("span", { className: "clip" }, element("b", {}, `${count} clips`))];
  }
  let first; // what is told of the first clip is not told again of one like it
  return lineup.takes.map((take, i) => {
    const swatch = element("i", { className: "swatch" });
    swatch.style.background = lineup.colours[i];
    const rate = Math.round(100 / take.frameTime) / 100;
    const facts = [`${take.frames.toLocaleString("en")} frames`, `${rate} fps`];
    if (take.clip.frameTime === null) facts[1] += " assumed";
    const kind = take.clip.markers ? "markers" : "joints";
    if (take.points)
      facts.push(`${take.jointNames.length} ${kind}`, `up ${axisName(take.bearings.up)}`);
    if (take.clip.maxError) facts.push(`values ±${take.clip.maxError}`);
    const text = facts.join(" · ");
    const isNews = i === 0 || text !== first;
    first ??= text;
    const name = element("b", {}, take.name);
    return element(
      "span",
      { className: "clip" },
      swatch,
      name,
      element("small", {}, isNews ? text : ""),
    );
  });
}

/** Names over the cells of a grid; nothing where there is only one. */
export function labelCells(place, lineup, viewport) {
  const cells = viewport.stages.length > 1 ? viewport.cells : [];
  while (place.children.length > cells.length) place.lastChild.remove();
  cells.forEach((cell, i) => {
    const label = place.children[i] ?? place.appendChild(element("span"));
    const [take] = viewport.stages[i].takes;
    if (label.textContent !== take.name) label.textContent = take.name;
    label.style.left = `${cell.x}px`;
    label.style.top = `${cell.y}px`;
    label.style.maxWidth = `${cell.width - 24}px`;
    label.style.borderColor = lineup.colours[lineup.takes.indexOf(take)];
  });
}

/** The list behind `?`. */
export function showKeys(place, bindings) {
  place.replaceChildren(
    ...bindings.flatMap(({ label, text }) => [
      element("dt", {}, element("kbd", {}, label)),
      element("dd", {}, text),
    ]),
  );
}
