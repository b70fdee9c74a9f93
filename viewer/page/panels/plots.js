import { short, trace, usualRange } from "./curve.js";
import { element, fittedContext, themeColour } from "./element.js";

const KIND_COLOURS = { x: "--x", y: "--y", z: "--z" };

/** Curves of channels, one below the other, with a line at the player's frame. */
export class Plots {
  /**
   * @param {HTMLElement} place
   * @param {import("../state/player.js").Player} player
   */
  constructor(place, player) {
    this.place = place;
    this.player = player;
    this.shown = [];
    player.addEventListener("change", () => this.#move());
    new ResizeObserver(() => this.draw()).observe(place);
  }

  /**
   * @param {import("../state/take.js").Take[]} takes channels of the others are drawn where they have
   *     the same names as the first one's
   * @param {number[]} columns of the first one
   * @param {string[]} colours
   * @param {(name: string) => string} [titleOf] a channel
   */
  show(takes, columns, colours, titleOf = (name) => name) {
    this.takes = takes;
    this.colours = colours;
    this.shown = columns.map((column) => {
      const [first] = takes;
      const name = first.clip.names[column];
      const kind = name.slice(name.lastIndexOf(".") + 1);
      const series = takes.map((take) => take.clip.channels[columnIn(take, name, column)]);
      const canvas = element("canvas", {});
      const cursor = element("i", { className: "cursor" });
      const value = element("output", {});
      const axis = element("i", { className: `axis ${kind.at(-1)}` });
      const title = element("div", {}, axis, element("b", {}, titleOf(name)), value);
      const curve = element("div", { className: "curve" }, canvas, cursor);
      const row = element("div", { className: "plot" }, title, curve);
      return { row, canvas, cursor, value, kind, series, range: padded(usualRange(series[0])) };
    });
    this.place.replaceChildren(...this.shown.map(({ row }) => row));
    this.draw();
  }

  draw() {
    if (!this.place.clientWidth) return;
    for (const plot of this.shown) this.#drawCurve(plot);
    this.#move();
  }

  #drawCurve({ canvas, kind, series, range }) {
    const { context, width, height } = fittedContext(canvas);
    const box = { left: 0, top: 3, width, height: height - 6 };
    const alone = themeColour(KIND_COLOURS[kind.at(-1)] ?? "--accent");
    const [low, high] = range;
    if (low < 0 && high > 0) {
      context.fillStyle = themeColour("--line");
      context.fillRect(0, box.top + box.height * (high / (high - low)), width, 1);
    }
    drawGaps(context, series[0], box);
    context.lineJoin = "round";
    series.forEach((values, i) => {
      if (!values) return;
      trace(context, values, box, range);
      context.strokeStyle = series.length > 1 ? this.colours[i] : alone;
      context.lineWidth = i === 0 && series.length > 1 ? 2.5 : 1.25;
      context.globalAlpha = i === 0 && series.length > 1 ? 0.6 : 1;
      context.stroke();
      context.globalAlpha = 1;
    });
  }

  /** Put the line and the values where the player is. */
  #move() {
    if (!this.shown.length || !this.place.clientWidth) return;
    const { time } = this.player;
    const [first] = this.takes;
    const share = first.frameAt(time) / Math.max(1, first.frames - 1);
    for (const { cursor, value, series } of this.shown) {
      cursor.style.left = `${100 * share}%`;
      value.textContent = series
        .map((values, i) => (values ? textAt(values, this.takes[i], time) : ""))
        .filter(Boolean)
        .join("  ");
    }
  }
}

/** Rows where a marker is missing are shaded. */
function drawGaps(context, values, box) {
  context.fillStyle = themeColour("--error");
  context.globalAlpha = 0.16;
  const x = (i) => box.left + (i / Math.max(1, values.length - 1)) * box.width;
  for (let i = 0; i < values.length; i++) {
    if (!Number.isNaN(values[i])) continue;
    const begin = i;
    while (i < values.length && Number.isNaN(values[i])) i++;
    context.fillRect(x(begin), 0, Math.max(1, x(i) - x(begin)), box.height + 6);
  }
  context.globalAlpha = 1;
}

/** The value at a time; of several values in a frame, the first. */
function textAt(values, take, time) {
  const value = values[take.frameAt(time) * Math.max(1, Math.round(values.length / take.frames))];
  return Number.isNaN(value) ? "missing" : short(value);
}

function columnIn(take, name, column) {
  return take.clip.names[column] === name ? column : take.clip.names.indexOf(name);
}

function padded([low, high]) {
  const room = (high - low) * 0.04 || Math.abs(high) * 0.05 || 1;
  return [low - room, high + room];
}
