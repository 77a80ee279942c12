// The help overlay, from the same lists that the keyboard goes by.
import type { Held, Pressed } from "./keys.js";

const POINTER: [string, string][] = [
  ["Drag", "orbit"],
  ["Shift-drag, right or middle drag", "pan"],
  ["Wheel, pinch on a touchpad", "zoom about the pointer"],
  ["One finger", "orbit"],
  ["Two fingers", "pan and pinch to zoom"],
  ["Drag a light's handle", "move it in the plane of the picture; with Shift away and nearer"],
];

function table(caption: string, rows: [string, string][]): HTMLTableElement {
  const made = document.createElement("table");
  made.createCaption().textContent = caption;
  for (const [keys, help] of rows) {
    const row = made.insertRow();
    const head = document.createElement("th");
    head.scope = "row";
    for (const key of keys.split("  ")) {
      const kbd = document.createElement("kbd");
      kbd.textContent = key;
      head.append(kbd, " ");
    }
    row.append(head);
    row.insertCell().textContent = help;
  }
  return made;
}

export function fillHelp(dialog: HTMLDialogElement, held: Held[], pressed: Pressed[]): void {
  const keys = [...held, ...pressed].map((one): [string, string] => [one.label, one.help]);
  dialog.querySelector("#help-tables")!.replaceChildren(table("Mouse and touch", POINTER), table("Keys", keys));
  dialog.addEventListener("click", (event) => {
    if (event.target === dialog) dialog.close(); // beside the box
  });
}
