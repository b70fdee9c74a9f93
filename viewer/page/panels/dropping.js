/**
 * Take files that are dropped on the page or chosen in a dialogue.
 *
 * @param {{veil: HTMLElement, replace: HTMLInputElement, add: HTMLInputElement}} parts the veil has
 *   two zones, marked data-drop
 * @param {(files: {name: string, bytes: Uint8Array}[], how: "replace"|"add") => void} take
 */
export function acceptFiles({ veil, replace, add }, take) {
  const read = async (list, how) => {
    const files = await Promise.all(
      [...list].map(async (file) => ({
        name: file.name,
        bytes: new Uint8Array(await file.arrayBuffer()),
      })),
    );
    if (files.length) take(files, how);
  };
  let depth = 0; // the pointer passes over many elements while it drags
  const dragged = (change) => (event) => {
    event.preventDefault();
    depth = Math.max(0, depth + change);
    veil.hidden = depth === 0;
  };
  addEventListener("dragenter", dragged(1));
  addEventListener("dragleave", dragged(-1));
  addEventListener("dragover", (event) => {
    event.preventDefault();
    const here = zoneOf(event);
    for (const zone of veil.querySelectorAll("[data-drop]")) {
      zone.classList.toggle("here", zone.dataset.drop === here);
    }
  });
  addEventListener("drop", (event) => {
    event.preventDefault();
    depth = 0;
    veil.hidden = true;
    read(event.dataTransfer?.files ?? [], zoneOf(event));
  });
  for (const [input, how] of [
    [replace, "replace"],
    [add, "add"],
  ]) {
    input.addEventListener("change", async () => {
      await read(input.files, how);
      input.value = "";
    });
  }
}

function zoneOf(event) {
  return event.target.closest?.("[data-drop]")?.dataset.drop ?? "replace";
}
