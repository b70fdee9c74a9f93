import { element } from "./element.js";

/** Messages over the page: what was wrong with a file. They stay until they are closed. */
export class Notices {
  /** @param {HTMLElement} place */
  constructor(place) {
    this.place = place;
  }

  /** @param {string[]} messages */
  show(messages) {
    this.place.replaceChildren(
      ...messages.slice(0, 5).map((message) => {
        const close = element("button", { type: "button", ariaLabel: "Close this message" }, "×");
        const notice = element("div", { className: "notice", role: "alert" }, message, close);
        close.addEventListener("click", () => notice.remove());
        return notice;
      }),
    );
  }
}
