// Keys for what is chosen, the same in the diagram and in the table.

import {
  arrange,
  beginRename,
  copySelected,
  cutSelected,
  focusOn,
  offerEnds,
  paste,
  removeSelected,
  select,
} from "../actions";
import { FIT_EVENT } from "../canvas/Tools";
import { nodeKey } from "../selection";
import { state, update } from "../store";

/** What a key does with what is chosen, by the name of the key. */
export const PART_KEYS: Record<string, () => void> = {
  Enter: openForm,
  C: () => void offerEnds(),
  F2: () => void beginRename(),
  Delete: () => void removeSelected(),
  Backspace: () => void removeSelected(),
  "Ctrl+C": () => void copySelected(),
  "Ctrl+X": () => void cutSelected(),
  "Ctrl+V": () => void paste(),
  "Ctrl+A": selectAll,
  U: () => focusOn("up"),
  D: () => focusOn("down"),
  O: () => focusOn("both"),
  A: () => void arrange(),
  "0": () => document.dispatchEvent(new Event(FIT_EVENT)),
  T: () => update({ middle: state().middle === "table" ? "diagram" : "table" }),
  Escape: leave,
};

function selectAll(): void {
  select((state().graph?.nodes ?? []).map((node) => nodeKey(node.id)));
}

function leave(): void {
  if (state().bright) focusOn(null);
  else select([]);
}

/** To the first field of the form. */
function openForm(): void {
  update({ right: "form" });
  requestAnimationFrame(() => {
    const form = document.querySelector(".right [role='tabpanel']");
    const field = form?.querySelector<HTMLElement>("input, select, textarea, button");
    field?.focus();
  });
}
