// Keys for what is chosen, the same in the diagram and in the table.

import { flushSync } from "react-dom";
import {
  arrange,
  beginRename,
  carriedBy,
  copySelected,
  cutSelected,
  fitAll,
  focusOn,
  offerBridges,
  offerEnds,
  offerHosts,
  removeSelected,
  select,
} from "../actions";
import { frameAround } from "../canvas/frames";
import { FIELDS } from "../panels/base/parts";
import { groupKey, nodeKey } from "../selection";
import { active, state, update } from "../store";

/** What a key does with what is chosen, by the name of the key. */
export const PART_KEYS: Record<string, () => void> = {
  Enter: openForm,
  C: () => void offerEnds(),
  H: () => (carriedBy().length ? offerBridges() : offerHosts()),
  F: toFrame,
  F2: () => void beginRename(),
  Delete: () => void removeSelected(),
  Backspace: () => void removeSelected(),
  "Ctrl+C": () => void copySelected(),
  "Ctrl+X": () => void cutSelected(),
  "Ctrl+A": selectAll,
  U: () => focusOn("up"),
  D: () => focusOn("down"),
  O: () => focusOn("both"),
  A: () => void arrange(),
  "0": fitAll,
  T: () => update({ middle: state().middle === "table" ? "diagram" : "table" }),
  Escape: leave,
};

/** Does what a key is for, and shows it at once: the very next key is for what this one opens. */
export function press(doing: () => unknown): void {
  flushSync(() => void doing());
}

function selectAll(): void {
  select((state().graph?.nodes ?? []).map((node) => nodeKey(node.id)));
}

/** From a box to the frame around it, and on to the frame around that. */
function toFrame(): void {
  const { graph } = state();
  const key = active(state());
  if (!graph || !key) return;
  const around = frameAround(graph, key);
  if (around) select([groupKey(around)]);
}

function leave(): void {
  if (state().bright) focusOn(null);
  else select([]);
}

/** To the first field of the form; while that is read, to where it comes, which hands on. */
function openForm(): void {
  flushSync(() => update({ right: "form" }));
  const panel = document.querySelector<HTMLElement>(".right [role='tabpanel']");
  if (panel) (panel.querySelector<HTMLElement>(FIELDS) ?? panel).focus();
}
