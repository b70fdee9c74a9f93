import { element } from "./element.js";

const AT_ONCE = 200; // rows that are made before the user asks for more

/**
 * @typedef {Object} StoredClip
 * @property {number} id
 * @property {string} name
 * @property {string} format
 * @property {number} frames
 * @property {number|null} seconds null where the source does not say its rate
 * @property {string|null} skeleton
 * @property {string[]} labels
 *
 * @typedef {Object} Hit what is like a clip
 * @property {number} id of a stored clip
 * @property {number} start its first frame that is alike
 * @property {[number, number]} seconds from where to where
 * @property {number} score the smaller, the more alike
 */

/** The list of a library's clips: filtered by what is typed and chosen, a click opens one. */
export class LibraryPanel extends EventTarget {
  /** @param {HTMLElement} panel */
  constructor(panel) {
    super();
    this.panel = panel;
    this.title = panel.querySelector("h2");
    this.search = panel.querySelector("[type=search]");
    this.choices = [...panel.querySelectorAll("select")];
    this.bounds = [...panel.querySelectorAll("[type=number]")];
    this.count = panel.querySelector("output");
    this.list = panel.querySelector(".clips");
    this.clips = [];
    for (const input of [this.search, ...this.choices, ...this.bounds]) {
      input.addEventListener("input", () => this.#filter());
    }
  }

  /**
   * @param {string} name of the library
   * @param {StoredClip[]} clips
   */
  show(name, clips) {
    this.clips = clips.map((clip) => ({ ...clip, words: wordsOf(clip) }));
    this.title.textContent = name;
    this.title.title = name;
    this.search.value = "";
    for (const bound of this.bounds) bound.value = "";
    for (const choice of this.choices) fill(choice, valuesOf(clips, choice.name));
    this.#filter();
  }

  /** Mark the clip that is shown. */
  mark(id) {
    this.marked = id;
    for (const row of this.list.querySelectorAll("[data-id]")) this.#markRow(row);
  }

  #markRow(row) {
    row.setAttribute("aria-selected", String(Number(row.dataset.id) === this.marked));
  }

  #filter() {
    const words = this.search.value.toLowerCase().split(/\s+/).filter(Boolean);
    const [least, most] = this.bounds.map(({ value }) => (value === "" ? null : Number(value)));
    const found = this.clips.filter(
      (clip) =>
        words.every((word) => clip.words.includes(word)) &&
        this.choices.every(({ name, value }) => !value || [clip[name]].flat().includes(value)) &&
        (least === null || (clip.seconds ?? -1) >= least) &&
        (most === null || (clip.seconds ?? Infinity) <= most),
    );
    const all = this.clips.length;
    this.count.textContent = found.length === all ? `${all} clips` : `${found.length} of ${all} clips`;
    this.list.replaceChildren();
    this.list.scrollTop = 0;
    this.#append(found);
  }

  /**
   * List what was found instead of all clips, until a filter is used.
   *
   * @param {string} what it is like
   * @param {Hit[]} hits
   */
  showHits(what, hits) {
    const byId = new Map(this.clips.map((clip) => [clip.id, clip]));
    const known = hits.filter(({ id }) => byId.has(id));
    const all = element("button", { className: "link" }, "all clips");
    all.addEventListener("click", () => this.#filter());
    this.count.replaceChildren(`${known.length} like ${what} · `, all);
    this.list.replaceChildren(...known.map((hit) => this.#row(byId.get(hit.id), hit)));
    this.list.scrollTop = 0;
  }

  #append(clips) {
    this.list.append(...clips.slice(0, AT_ONCE).map((clip) => this.#row(clip)));
    const rest = clips.slice(AT_ONCE);
    if (!rest.length) return;
    const more = element("button", { className: "more" }, `${rest.length} more`);
    more.addEventListener("click", () => {
      more.remove();
      this.#append(rest);
    });
    this.list.append(more);
  }

  #row(clip, hit) {
    const folder = clip.name.slice(0, clip.name.lastIndexOf("/") + 1);
    const name = element("b", {}, clip.name.slice(folder.length));
    const row = element(
      "button",
      { role: "option", title: `${clip.name} (with Shift: beside the clips shown)` },
      element("span", {}, folder ? element("i", {}, folder) : "", name),
      element("small", {}, hit ? placeOf(hit, clip) : factsOf(clip)),
    );
    row.dataset.id = String(clip.id);
    this.#markRow(row);
    row.addEventListener("click", ({ shiftKey }) => {
      const detail = { clip, how: shiftKey ? "add" : "replace", start: hit?.start ?? 0 };
      this.dispatchEvent(new CustomEvent("choose", { detail }));
    });
    return row;
  }
}

function factsOf({ frames, seconds, skeleton, labels }) {
  const length = seconds === null ? "" : `${seconds.toFixed(seconds < 10 ? 2 : 1)} s`;
  return [`${frames} frames`, length, skeleton ?? "", ...labels].filter(Boolean).join(" · ");
}

function placeOf({ seconds, score }, { labels }) {
  const [from, to] = seconds.map((second) => second.toFixed(2));
  return [`${from} to ${to} s`, `score ${score.toFixed(2)}`, ...labels].join(" · ");
}

function wordsOf({ name, format, skeleton, labels }) {
  return [name, format, skeleton ?? "", ...labels].join("\n").toLowerCase();
}

function valuesOf(clips, property) {
  return [...new Set(clips.flatMap((clip) => clip[property] ?? []))].filter(Boolean).sort();
}

/** Offer the values of a property, where there is a choice. */
function fill(choice, values) {
  const any = element("option", { value: "" }, choice.title);
  choice.replaceChildren(any, ...values.map((value) => element("option", { value }, value)));
  choice.hidden = values.length < 2;
}
