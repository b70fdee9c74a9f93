import { acceptFiles } from "./panels/dropping.js";
import { element } from "./panels/element.js";
import { Inspector } from "./panels/inspector.js";
import { listenToKeys } from "./panels/keyboard.js";
import { labelCells, legend, showKeys } from "./panels/labels.js";
import { lengthText } from "./panels/lengths.js";
import { LibraryPanel } from "./panels/library.js";
import { Notices } from "./panels/notice.js";
import { Plots } from "./panels/plots.js";
import { Timeline } from "./panels/timeline.js";
import { message } from "./reading/files.js";
import { DroppedLibrary, isLibrary } from "./reading/dropped_library.js";
import { paint, stagesOf } from "./scene/staging.js";
import { Viewport } from "./scene/viewport.js";
import { axisName } from "./state/bearings.js";
import { speeds } from "./state/comparison.js";
import { Lineup, MOST_AT_ONCE } from "./state/lineup.js";
import { Player } from "./state/player.js";
import { Take } from "./state/take.js";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4];
const MOST_CURVES = 120; // of a clip without a figure
const MODE_NAMES = { compare: "Compare", together: "One scene", apart: "Side by side" };

/** The page as a whole: what the controls do. */
export class App {
  /** @param {import("./work/reader.js").Reader} reader */
  constructor(reader) {
    this.reader = reader;
    this.at = (id) => document.getElementById(id);
    this.notices = new Notices(this.at("notices"));
    this.player = new Player();
    this.lineup = new Lineup();
    this.viewport = new Viewport(this.at("canvas"));
    this.timeline = new Timeline(this.at("timeline"), this.player);
    this.inspector = new Inspector(this.at("inspector"), this.player);
    this.curves = new Plots(this.at("curves"), this.player);
    this.libraryPanel = new LibraryPanel(this.at("library"));
    this.library = null;
    this.trails = true;
    this.#wire();
    this.#setTheme(matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
    this.#toggleInspector(matchMedia("(min-width: 900px)").matches && innerHeight > 420);
    this.#tick(performance.now());
  }

  /** Show the clips that the page carries. */
  async openEmbedded(text) {
    const shown = await this.#read("replace", (begun) => this.reader.embedded(text, begun));
    this.player.play(shown && !matchMedia("(prefers-reduced-motion: reduce)").matches);
  }

  /** Show files; of a file that is broken, a message says what is wrong with it. */
  async openFiles(files, how) {
    const dropped = files.find(isLibrary);
    if (dropped) await this.openLibrary(new DroppedLibrary(dropped, this.reader));
    else if (await this.#read(how, (begun) => this.reader.files(files, begun))) this.player.play(true);
  }

  /**
   * Show a library's list, and its first clip.
   *
   * @param {import("./reading/served.js").ServedLibrary} library
   */
  async openLibrary(library) {
    document.body.classList.add("reading");
    const { clips, errors } = await library.catalogue();
    document.body.classList.remove("reading");
    this.notices.show(errors);
    if (errors.length) return;
    this.library = library;
    this.libraryPanel.show(library.name, clips);
    this.at("show-library").hidden = false;
    this.at("library").querySelector(".similar").hidden = !library.similar;
    this.#toggleLibrary(true);
    if (clips.length && !isNarrow()) await this.#openStored(clips[0], "replace");
    else if (!this.lineup.takes.length) document.body.classList.add("empty");
  }

  async #openStored(clip, how, start = 0) {
    this.libraryPanel.mark(clip.id);
    if (isNarrow()) this.#toggleLibrary(false);
    this.asked = clip;
    const { library } = this;
    const isWanted = () => how === "add" || this.asked === clip;
    const shown = await this.#read(how, (begun) => library.read(clip, begun), isWanted);
    if (shown && start) this.player.seek(start);
    if (shown) this.player.play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
  }

  /** List what is like the clip that was opened last, or like the stretch that is marked. */
  async #findSimilar() {
    const { library, asked, timeline } = this;
    if (!library?.similar || !asked) return;
    const { stretch } = timeline;
    document.body.classList.add("reading");
    const { hits, errors } = await library.similar(asked, stretch);
    document.body.classList.remove("reading");
    this.notices.show(errors);
    if (errors.length) return;
    const frames = stretch ? `frames ${stretch[0] + 1} to ${stretch[1]} of ` : "";
    this.libraryPanel.showHits(`${frames}${asked.name}`, hits);
    this.libraryPanel.mark(asked.id);
    this.#toggleLibrary(true);
  }

  #showMark() {
    const { stretch, begun } = this.timeline;
    this.at("similar").textContent = stretch
      ? `Find frames ${stretch[0] + 1} to ${stretch[1]}`
      : "Find similar clips";
    this.at("mark").textContent = begun === null ? "Mark" : `Mark from ${begun + 1} to here`;
  }

  /** Show what is read, of long clips the beginning while the rest is read; whether there is any. */
  async #read(how, read, isWanted = () => true) {
    document.body.classList.add("reading");
    const { clips, errors } = await read((beginning) => {
      if (how === "replace" && isWanted()) this.#open(beginning.clips, [], how);
    });
    if (!isWanted()) return false; // another was chosen meanwhile
    document.body.classList.remove("reading");
    this.#open(clips, errors, how);
    return clips.length > 0;
  }

  #open(clips, errors, how) {
    const takes = how === "add" ? [...this.lineup.all] : [];
    const notes = [];
    for (const clip of clips) {
      try {
        takes.push(new Take(clip));
        for (const note of clip.notes ?? []) notes.push(`${clip.name}: ${note}`);
      } catch (error) {
        errors.push(message(error, clip.name));
      }
    }
    this.notices.show(errors, notes);
    if (takes.length) this.#show(() => this.lineup.set(takes));
    else if (!this.lineup.takes.length) document.body.classList.add("empty");
  }

  /** Change who is shown. */
  #show(change) {
    const { lineup } = this;
    document.body.classList.remove("empty");
    change();
    this.timeline.mark();
    this.player.measure(lineup.longest.frames, lineup.longest.frameTime);
    this.#showCurves();
    this.#arrange();
  }

  /** A clip without a figure shows its curves instead. */
  #showCurves() {
    const { figures, takes, colours } = this.lineup;
    const place = this.at("curves");
    place.hidden = figures.length > 0;
    document.body.classList.toggle("bare", !place.hidden);
    if (!place.hidden) {
      this.curves.show(takes.slice(0, 1), [...takes[0].clip.names.keys()].slice(0, MOST_CURVES), colours);
    }
  }

  #turnPage(by) {
    const { lineup } = this;
    if (lineup.pages > 1) this.#show(() => lineup.turnTo((lineup.page + by + lineup.pages) % lineup.pages));
  }

  /** Rebuild the stages: the clips, the way of comparing or the up axis have changed. */
  #arrange() {
    const { lineup, viewport } = this;
    viewport.show(stagesOf(lineup));
    const compared = lineup.isCompared;
    document.body.classList.toggle("compared", compared);
    this.inspector.show(compared ? lineup.takes : lineup.takes.slice(0, 1), lineup.colours);
    this.at("mode").hidden = lineup.modes.length < 2;
    this.at("mode").textContent = MODE_NAMES[lineup.nextMode];
    this.at("pages").hidden = lineup.pages < 2;
    const first = lineup.page * MOST_AT_ONCE;
    this.at("page").textContent = `${first + 1}–${first + lineup.takes.length} of ${lineup.all.length}`;
    this.at("follow").setAttribute("aria-pressed", String(viewport.follows));
    this.at("legend").replaceChildren(...legend(lineup));
    this.#plot();
    this.#applyTrails();
    this.#changed();
  }

  #plot() {
    const { lineup, timeline } = this;
    if (!lineup.takes.length) return;
    const { comparison, isCompared, takes } = lineup;
    const text = lengthText(takes[0]);
    if (isCompared) {
      const curves = [
        { values: comparison.worst, colour: "--error", fill: true },
        { values: comparison.mean, colour: "--muted" },
      ];
      timeline.plot("largest error", curves, text);
      this.at("worst").textContent = text(comparison.largest);
      this.at("average").textContent = text(comparison.average);
    } else {
      const curves = [{ values: speeds(lineup.longest), colour: "--accent", fill: true }];
      timeline.plot("mean speed", curves, (speed) => `${text(speed)}/s`);
    }
  }

  /** Show the player's moment everywhere. */
  #changed() {
    const { player, lineup, viewport } = this;
    paint(lineup, viewport.stages, player.time, this.inspector.chosen, viewport.mark);
    for (const stage of viewport.stages) stage.show(player.time, viewport.follows);
    viewport.dirty = true;
    const { frame, frames, frameTime, time } = player;
    this.at("frame").textContent = `${frame + 1} / ${frames}`;
    this.at("time").textContent = `${time.toFixed(2)} / ${(frames * frameTime).toFixed(2)} s`;
    this.at("play").setAttribute("aria-pressed", String(player.playing));
    this.at("play").ariaLabel = player.playing ? "Pause" : "Play";
    this.at("speed").value = String(player.speed);
    if (lineup.takes.length) document.body.dataset.frame = String(frame);
  }

  #tick(before) {
    requestAnimationFrame((now) => {
      // A frame's time can lie before that of its request; a hidden page gets none for long.
      this.player.advance(Math.min(0.1, Math.max(0, now - before) / 1000));
      this.viewport.render();
      labelCells(this.at("cells"), this.lineup, this.viewport);
      this.#tick(now);
    });
  }

  #wire() {
    const { player, at } = this;
    const actions = {
      play: () => player.play(),
      back: () => player.step(-1),
      forward: () => player.step(1),
      mode: () => this.#changeMode(),
      up: () => this.#turnUp(),
      trail: () => this.#toggleTrails(),
      "page-back": () => this.#turnPage(-1),
      "page-on": () => this.#turnPage(1),
      follow: () => this.#toggleFollow(),
      reframe: () => this.viewport.frame(),
      "show-inspector": () => this.#toggleInspector(),
      "close-inspector": () => this.#toggleInspector(false),
      "show-library": () => this.#toggleLibrary(),
      "close-library": () => this.#toggleLibrary(false),
      similar: () => this.#findSimilar(),
      mark: () => this.timeline.markHere(),
      theme: () =>
        this.#setTheme(document.documentElement.dataset.theme === "dark" ? "light" : "dark"),
      help: () => this.#toggleHelp(),
      "close-help": () => at("keys").close(),
      open: () => at("replace-files").click(),
      "open-first": () => at("replace-files").click(),
      add: () => at("add-files").click(),
      heat: () => this.#toggleErrors(),
    };
    for (const [id, act] of Object.entries(actions)) at(id).addEventListener("click", act);
    at("speed").append(
      ...SPEEDS.map((speed) => element("option", { value: String(speed) }, `${speed}×`)),
    );
    at("speed").addEventListener("change", () => player.setSpeed(Number(at("speed").value)));
    player.addEventListener("change", () => this.#changed());
    this.inspector.addEventListener("choose", () => this.#changed());
    this.libraryPanel.addEventListener("choose", ({ detail: { clip, how, start } }) =>
      this.#openStored(clip, how, start),
    );
    this.timeline.addEventListener("mark", () => this.#showMark());
    const parts = { veil: at("veil"), replace: at("replace-files"), add: at("add-files") };
    acceptFiles(parts, (files, how) => this.openFiles(files, how));
    const bindings = this.#bindings();
    listenToKeys(bindings);
    showKeys(at("bindings"), bindings);
    this.#pickJoints();
  }

  /** @returns {import("./panels/keyboard.js").Binding[]} */
  #bindings() {
    const { player } = this;
    const second = () => Math.round(1 / player.frameTime);
    const by = (direction) => (event) => player.step(direction * (event.shiftKey ? second() : 1));
    return [
      { keys: [" ", "k"], label: "Space", text: "play or pause", act: () => player.play() },
      {
        keys: ["ArrowLeft", ","],
        label: "←",
        text: "one frame back; with Shift, one second",
        act: by(-1),
      },
      {
        keys: ["ArrowRight", "."],
        label: "→",
        text: "one frame forward; with Shift, one second",
        act: by(1),
      },
      { keys: ["Home"], label: "Home", text: "first frame", act: () => player.seek(0) },
      { keys: ["End"], label: "End", text: "last frame", act: () => player.step(player.frames) },
      { keys: ["-", "["], label: "−", text: "slower", act: () => this.#changeSpeed(-1) },
      { keys: ["+", "=", "]"], label: "+", text: "faster", act: () => this.#changeSpeed(1) },
      {
        keys: ["o"],
        label: "O",
        text: "compare, in one scene, or side by side",
        act: () => this.#changeMode(),
      },
      { keys: ["e"], label: "E", text: "error as colour", act: () => this.#toggleErrors() },
      { keys: ["c"], label: "C", text: "camera follows or stays", act: () => this.#toggleFollow() },
      {
        keys: ["f", "r"],
        label: "F",
        text: "show the whole figure again",
        act: () => this.viewport.frame(),
      },
      { keys: ["u"], label: "U", text: "try another up axis", act: () => this.#turnUp() },
      { keys: ["t"], label: "T", text: "trail of the root", act: () => this.#toggleTrails() },
      {
        keys: ["i"],
        label: "I",
        text: "inspector of channels",
        act: () => this.#toggleInspector(),
      },
      { keys: ["l"], label: "L", text: "list of the library", act: () => this.#toggleLibrary() },
      {
        keys: ["m"],
        label: "M",
        text: "mark a stretch from here, then to here; or drag with Shift",
        act: () => this.timeline.markHere(),
      },
      { keys: ["s"], label: "S", text: "find what is similar", act: () => this.#findSimilar() },
      { keys: ["d"], label: "D", text: "dark or light", act: () => this.at("theme").click() },
      { keys: ["PageDown"], label: "Page ↓", text: "the next clips", act: () => this.#turnPage(1) },
      { keys: ["PageUp"], label: "Page ↑", text: "the clips before", act: () => this.#turnPage(-1) },
      { keys: ["?"], label: "?", text: "this list", act: () => this.#toggleHelp() },
    ];
  }

  /** A click, or a tap, that is no drag chooses the joint under it. */
  #pickJoints() {
    const canvas = this.at("canvas");
    let down = null;
    canvas.addEventListener("pointerdown", (event) => (down = [event.clientX, event.clientY]));
    canvas.addEventListener("pointerup", (event) => {
      if (!down || Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 4) return;
      const box = canvas.getBoundingClientRect();
      const found = this.viewport.pick(event.clientX - box.left, event.clientY - box.top);
      if (!found) return;
      const { take, point } = found;
      if (take !== this.lineup.takes[0] && !this.lineup.isCompared) return;
      const joint = point < take.jointNames.length ? point : take.parents[point];
      this.inspector.choose(joint);
    });
  }

  #changeSpeed(by) {
    const here = SPEEDS.indexOf(this.player.speed) + by;
    this.player.setSpeed(SPEEDS[Math.min(SPEEDS.length - 1, Math.max(0, here))]);
  }

  #changeMode() {
    if (this.lineup.modes.length < 2) return;
    this.lineup.changeMode();
    this.#arrange();
  }

  #toggleErrors() {
    this.lineup.errorsShown = !this.lineup.errorsShown;
    this.at("heat").setAttribute("aria-pressed", String(this.lineup.errorsShown));
    this.#changed();
  }

  #toggleFollow() {
    this.viewport.follows = !this.viewport.follows;
    this.at("follow").setAttribute("aria-pressed", String(this.viewport.follows));
    this.viewport.frame();
    this.#changed();
  }

  #toggleTrails() {
    this.trails = !this.trails;
    this.at("trail").setAttribute("aria-pressed", String(this.trails));
    this.#applyTrails();
  }

  #applyTrails() {
    for (const stage of this.viewport.stages) stage.showTrails(this.trails);
    this.viewport.dirty = true;
  }

  #turnUp() {
    if (!this.lineup.figures.length) return;
    this.lineup.turnUp();
    this.#arrange();
    this.notices.show([], [`the up axis is now ${axisName(this.lineup.takes[0].bearings.up)}`]);
  }

  #toggleInspector(shown = this.at("inspector").hidden) {
    this.at("inspector").hidden = !shown;
    this.at("show-inspector").setAttribute("aria-pressed", String(shown));
    this.inspector.draw();
  }

  #toggleLibrary(shown = this.at("library").hidden) {
    this.at("library").hidden = !shown || !this.library;
    this.at("show-library").setAttribute("aria-pressed", String(!this.at("library").hidden));
  }

  #toggleHelp() {
    const keys = this.at("keys");
    if (keys.open) keys.close();
    else keys.showModal();
  }

  #setTheme(theme) {
    document.documentElement.dataset.theme = theme;
    this.viewport.setTheme(theme);
    this.timeline.plot(this.timeline.label, this.timeline.curves, this.timeline.text);
    this.curves.draw();
    this.inspector.draw();
    this.#changed();
  }
}

function isNarrow() {
  return matchMedia("(max-width: 760px)").matches;
}
