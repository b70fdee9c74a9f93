import { element } from "./element.js";

const MOST = 5;
const STAY = 8000; // ms; no error goes by itself

/** Messages beside the figure: what was wrong with a file, which stays, and what is worth knowing. */
export class Notices {
  /** @param {HTMLElement} place */
  constructor(place) {
    this.place = place;
  }

  /**
   * Show these, and those of before no more.
   *
   * @param {string[]} errors
   * @param {string[]} [notes]
   */
  show(errors, notes = []) {
    const all = [
      ...errors.map((text) => notice(text, "alert")),
      ...notes.map((text) => notice(text, "status")),
    ];
    this.place.replaceChildren(...all.slice(0, MOST));
  }
}

function notice(text, role) {
  const close = element("button", { type: "button", ariaLabel: "Close this message" }, "×");
  const made = element("div", { className: "notice", role }, text, close);
  close.addEventListener("click", () => made.remove());
  if (role === "status") {
    made.classList.add("fading");
    setTimeout(() => made.remove(), STAY);
  }
  return made;
}
