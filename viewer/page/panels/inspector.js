import { element } from "./element.js";
import { Plots } from "./plots.js";

/** The panel beside the figure: joints, and the curves of the chosen one's channels. */
export class Inspector extends EventTarget {
  /**
   * @param {HTMLElement} panel
   * @param {import("../state/player.js").Player} player
   */
  constructor(panel, player) {
    super();
    this.panel = panel;
    this.list = panel.querySelector("[role=listbox]");
    this.place = panel.querySelector(".plots");
    this.plots = new Plots(this.place, player);
    this.search = panel.querySelector("input");
    this.takes = [];
    this.search.addEventListener("input", () => this.#filter());
    this.search.addEventListener("keydown", (event) => {
      if (event.key === "Enter") this.#chooseFound();
    });
    this.list.addEventListener("change", () => this.choose(Number(this.list.value)));
  }

  /**
   * @param {import("../state/take.js").Take[]} takes the first one's joints are listed; channels of
   * the others are drawn where they have the same names; the chosen joint stays where the first one does
   * @param {string[]} colours
   */
  show(takes, colours) {
    const isKept = takes.length > 0 && takes[0] === this.takes[0];
    this.takes = takes;
    this.colours = colours;
    this.groups = takes.length ? channelGroups(takes[0].clip) : [];
    this.search.value = "";
    this.#filter();
    const { root } = takes[0] ?? {};
    const first = this.groups.findIndex((group, i) => group.channels.length && i >= root);
    this.choose(isKept ? this.chosen : first, { quietly: true });
  }

  /** Choose a joint by its index. */
  choose(index, { quietly = false } = {}) {
    this.chosen = index;
    this.list.value = String(index);
    this.#plot();
    if (!quietly) this.dispatchEvent(new Event("choose"));
  }

  draw() {
    this.plots.draw();
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

  /** Choose the first joint of those found: the one of just this name, or else that is listed first. */
  #chooseFound() {
    const wanted = this.search.value.trim().toLowerCase();
    const found = [...this.list.options].filter((option) => !option.disabled);
    const same = found.find((option) => option.text.trim().toLowerCase() === wanted);
    const option = same ?? found[0];
    if (option) this.choose(Number(option.value));
  }

  #plot() {
    const group = this.groups[this.chosen];
    this.plots.show(this.takes, group?.channels ?? [], this.colours, kindText);
    if (group && !group.channels.length) {
      const text = "no channels: it moves with its parent";
      this.place.replaceChildren(element("p", { className: "hint" }, text));
    }
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

function kindText(name) {
  const kind = name.slice(name.lastIndexOf(".") + 1);
  const what = { t: "position", r: "rotation" }[kind[0]];
  return /^[tr][xyz]$/.test(kind) ? `${kind[1]} ${what}` : kind;
}
