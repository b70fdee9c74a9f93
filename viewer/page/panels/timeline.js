import { short, trace, usualRange } from "./curve.js";
import { element, fittedContext, themeColour } from "./element.js";

/** The plot over time at the foot of the page; to drag is to scrub, and with Shift to mark a stretch. */
export class Timeline extends EventTarget {
  /**
   * @param {HTMLElement} slider holds the canvas
   * @param {import("../state/player.js").Player} player
   */
  constructor(slider, player) {
    super();
    this.slider = slider;
    this.player = player;
    this.canvas = slider.querySelector("canvas");
    this.tip = element("div", { className: "tip", hidden: true });
    slider.append(this.tip);
    this.curves = [];
    this.label = "";
    this.stretch = null;
    this.begun = null; // the frame from which a stretch is being marked
    this.from = null; // the same, while it is dragged
    this.#listen();
    new ResizeObserver(() => this.#redraw()).observe(this.canvas);
    player.addEventListener("change", () => this.draw());
  }

  /**
   * @param {string} label what is plotted: "error"
   * @param {{values: Float32Array, colour: string, fill?: boolean}[]} curves colours of the theme
   * @param {(value: number) => string} [text] of a value
   */
  plot(label, curves, text = short) {
    this.label = label;
    this.curves = curves;
    this.text = text;
    this.#redraw();
  }

  /**
   * Mark a stretch; less than two frames are none.
   *
   * @param {number} [first] frame
   * @param {number} [last] frame, in any order
   */
  mark(first = 0, last = first) {
    const ends = [Math.round(Math.min(first, last)), Math.round(Math.max(first, last)) + 1];
    this.stretch = ends[1] - ends[0] < 2 ? null : ends;
    this.begun = null;
    this.draw();
    this.dispatchEvent(new Event("mark"));
  }

  /** Mark from the frame that is shown; when asked again, to the one that is shown then. */
  markHere() {
    const { frame } = this.player;
    if (this.begun !== null && this.begun !== frame) return this.mark(this.begun, frame);
    this.mark();
    this.begun = frame;
    this.dispatchEvent(new Event("mark"));
  }

  draw() {
    const { player } = this;
    if (!this.curvesDrawn) this.#drawCurves();
    const { context, width, height } = fittedContext(this.canvas);
    if (this.curvesDrawn.width) context.drawImage(this.curvesDrawn, 0, 0, width, height);
    if (this.stretch) {
      const [from, to] = this.stretch.map((frame) => this.#xOf(Math.min(frame, player.frames - 1), width));
      context.globalAlpha = 0.2;
      context.fillStyle = themeColour("--accent");
      context.fillRect(from, 0, to - from, height);
      context.globalAlpha = 1;
    }
    const x = this.#xOf(player.frame, width);
    context.fillStyle = themeColour("--ink");
    context.fillRect(x - 0.75, 0, 1.5, height);
    context.beginPath();
    context.arc(x, 5, 4.5, 0, 2 * Math.PI);
    context.fill();
    this.slider.setAttribute("aria-valuenow", String(player.frame));
    this.slider.setAttribute("aria-valuemax", String(player.frames - 1));
  }

  #redraw() {
    this.curvesDrawn = null;
    this.draw();
  }

  /** The curves change seldom; they are drawn once, beside the page. */
  #drawCurves() {
    const made = document.createElement("canvas");
    const ratio = Math.min(2, window.devicePixelRatio);
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    made.width = Math.round(width * ratio);
    made.height = Math.round(height * ratio);
    this.curvesDrawn = made;
    const context = made.getContext("2d");
    if (!context || !width) return;
    context.scale(ratio, ratio);
    const high = Math.max(...this.curves.map(({ values }) => usualRange(values)[1]), 0);
    const box = { left: 5, top: 8, width: width - 10, height: height - 10 };
    context.fillStyle = themeColour("--line");
    context.fillRect(5, height - 2, width - 10, 1);
    for (const { values, colour, fill } of this.curves) {
      trace(context, values, box, [0, high]);
      context.lineJoin = "round";
      context.lineWidth = 1.25;
      context.strokeStyle = themeColour(colour);
      context.stroke();
      if (!fill) continue;
      context.lineTo(box.left + box.width, height - 2);
      context.lineTo(box.left, height - 2);
      context.globalAlpha = 0.16;
      context.fillStyle = themeColour(colour);
      context.fill();
      context.globalAlpha = 1;
    }
  }

  #listen() {
    const { slider, player } = this;
    const frameOf = (event) => {
      const box = this.canvas.getBoundingClientRect();
      const share = (event.clientX - box.left - 5) / Math.max(1, box.width - 10);
      return Math.min(1, Math.max(0, share)) * (player.frames - 1);
    };
    slider.addEventListener("pointerdown", (event) => {
      slider.setPointerCapture(event.pointerId);
      this.resume = player.playing && !event.shiftKey;
      this.from = event.shiftKey ? frameOf(event) : null;
      if (event.shiftKey) this.mark();
      player.play(false);
      player.seek(frameOf(event));
    });
    slider.addEventListener("pointermove", (event) => {
      if (slider.hasPointerCapture(event.pointerId)) {
        if (this.from !== null) this.mark(this.from, frameOf(event));
        player.seek(frameOf(event));
      }
      this.#showTip(Math.round(frameOf(event)));
    });
    slider.addEventListener("pointerup", (event) => {
      if (this.resume) player.play(true);
      if (event.pointerType !== "mouse") this.tip.hidden = true;
    });
    slider.addEventListener("pointerleave", () => (this.tip.hidden = true));
  }

  #showTip(frame) {
    const [curve] = this.curves;
    this.tip.hidden = !curve;
    if (!curve || frame >= curve.values.length) return;
    this.tip.textContent = `${frame + 1} · ${this.label} ${this.text(curve.values[frame])}`;
    const width = this.canvas.clientWidth;
    const half = this.tip.offsetWidth / 2;
    const x = Math.min(width - half, Math.max(half, this.#xOf(frame, width)));
    this.tip.style.left = `${x}px`;
  }

  #xOf(frame, width) {
    return 5 + (frame / Math.max(1, this.player.frames - 1)) * (width - 10);
  }
}
