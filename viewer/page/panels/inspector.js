import { rangeOf, short, trace } from "./curve.js";
import { element, fittedContext, themeColour } from "./element.js";

const KIND_COLOURS = { x: "--x", y: "--y", z: "--z" };

/** The panel beside the figure: joints, and the curves of the chosen one's channels. */
export class Inspector extends EventTarget {
  /**
   * @param {HTMLElement} panel
   * @param {import("../state/player.js").Player} player
   */
  constructor(panel, player) {
    super();
    this.panel = panel;
    this.player = player;
    this.list = panel.querySelector("[role=listbox]");
    this.plots = panel.querySelector(".plots");
    this.search = panel.querySelector("input");
    this.takes = [];
    this.drawn = [];
    this.search.addEventListener("input", () => this.#filter());
    this.list.addEventListener("change", () => this.choose(Number(this.list.value)));
    player.addEventListener("change", () => this.draw());
    new ResizeObserver(() => this.draw()).observe(this.plots);
  }

  /**
   * @param {import("../state/take.js").Take[]} takes the first one's joints are listed; channels of
   * the others are drawn where they have the same names
   * @param {string[]} colours
   */
  show(takes, colours) {
    this.takes = takes;
    this.colours = colours;
    this.groups = takes.length ? channelGroups(takes[0].clip) : [];
    this.search.value = "";
    this.#filter();
    const first = this.groups.findIndex((group) => group.channels.length);
    this.choose(first, { quietly: true });
  }

  /** Choose a joint by its index. */
  choose(index, { quietly = false } = {}) {
    this.chosen = index;
    this.list.value = String(index);
    this.#plot();
    if (!quietly) this.dispatchEvent(new Event("choose"));
  }

  draw() {
    if (this.panel.hidden) return;
    for (const plot of this.drawn) this.#drawPlot(plot);
  }

  #filter() {
    const wanted = this.search.value.trim().toLowerCase();
    const options = [];
    this.groups.forEach(({ name, depth, channels }, index) => {
      if (!name.toLowerCase().includes(wanted)) return;
      const indent = wanted ? "" : "\u2007".repeat(Math.min(depth, 10));
      const text = `${indent}${name}`;
      options.push(element("option", { value: String(index), disabled: !channels.length }, text));
    });
    this.list.replaceChildren(...options);
    this.list.value = String(this.chosen);
  }

  #plot() {
    this.drawn = [];
    const group = this.groups[this.chosen];
    const rows = (group?.channels ?? []).map((column) => {
      const [first] = this.takes;
      const name = first.clip.names[column];
      const value = element("output", {});
      const kind = name.slice(name.lastIndexOf(".") + 1);
      const canvas = element("canvas", {});
      const series = this.takes.map((take) => take.clip.channels[columnIn(take, name, column)]);
      const range = padded(rangeOf(series[0]));
      this.drawn.push({ canvas, value, kind, series, range });
      const axis = element("i", { className: `axis ${kind.at(-1)}` });
      const title = element("div", {}, axis, element("b", {}, kindText(kind)), value);
      return element("div", { className: "plot" }, title, canvas);
    });
    if (!rows.length) {
      const text = group ? "no channels: it moves with its parent" : "";
      rows.push(element("p", { className: "hint" }, text));
    }
    this.plots.replaceChildren(...rows);
    this.draw();
  }

  #drawPlot({ canvas, value, kind, series, range }) {
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
    const [first] = this.takes;
    const frame = first.frameAt(this.player.time);
    context.fillStyle = themeColour("--ink");
    context.globalAlpha = 0.7;
    context.fillRect((frame / Math.max(1, first.frames - 1)) * width - 0.5, 0, 1, height);
    context.globalAlpha = 1;
    value.textContent = series
      .filter(Boolean)
      .map((values, i) => textAt(values, this.takes[i], this.player.time))
      .join("  ");
  }
}

/** Per joint, marker or analog channel its name, depth in the tree and columns; without a skeleton by parts of names. */
function channelGroups(clip) {
  if (clip.skeleton) {
    const { joints, columns } = clip.skeleton;
    const groups = joints.map(({ name }) => ({ name, depth: 0, channels: [] }));
    joints.forEach(({ parent }, i) => {
      if (parent >= 0) groups[i].depth = groups[parent].depth + 1;
    });
    columns.forEach(([joint], column) => groups[joint]?.channels.push(column));
    return groups;
  }
  if (clip.markers) {
    const { labels } = clip.markers;
    const groups = labels.map((name, i) => ({ name, depth: 0, channels: [0, 1, 2].map((k) => 3 * i + k) }));
    const analog = clip.names.slice(3 * labels.length);
    const own = analog.map((name, i) => ({ name, depth: 0, channels: [3 * labels.length + i] }));
    return [...groups, ...own];
  }
  const byName = new Map();
  clip.names.forEach((name, column) => {
    const joint = name.includes(".") ? name.slice(0, name.lastIndexOf(".")) : name;
    if (!byName.has(joint)) byName.set(joint, { name: joint, depth: 0, channels: [] });
    byName.get(joint).channels.push(column);
  });
  return [...byName.values()];
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

function kindText(kind) {
  const what = { t: "position", r: "rotation" }[kind[0]];
  return /^[tr][xyz]$/.test(kind) ? `${kind[1]} ${what}` : kind;
}
