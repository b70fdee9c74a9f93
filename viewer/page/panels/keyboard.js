/**
 * Keys, what they do and how `?` lists them.
 *
 * @typedef {Object} Binding
 * @property {string[]} keys
 * @property {string} label of the first one
 * @property {string} text
 * @property {(event: KeyboardEvent) => void} act
 */

/** @param {Binding[]} bindings */
export function listenToKeys(bindings) {
  const byKey = new Map(bindings.flatMap((binding) => binding.keys.map((key) => [key, binding])));
  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || isTyping(event)) return;
    const binding = byKey.get(event.key.length === 1 ? event.key.toLowerCase() : event.key);
    if (!binding) return;
    event.preventDefault();
    binding.act(event);
  });
}

/** Keys belong to the fields and lists that have the focus; the space bar to a button. */
function isTyping(event) {
  const { target } = event;
  if (event.key === "Escape" || event.key === "?") return false;
  if (target.matches?.("input, select, textarea")) return true;
  return event.key === " " && target.matches?.("button, summary");
}
