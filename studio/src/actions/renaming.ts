// Giving elements other names.

import type { Ref } from "../protocol";
import { elementOf, has, partOf } from "../selection";
import { active, revisionOf, say, state, update } from "../store";
import { ask, tried } from "./asking";
import { edit } from "./changing";
import { select } from "./choosing";

/** Begins to rename what the keyboard stands on. */
export async function beginRename(key = active(state())): Promise<void> {
  const { graph } = state();
  const element = graph && key ? elementOf(graph, key) : "";
  if (!key || !element) return say("What is selected has no name to change.");
  const base = revisionOf(state());
  const form = await tried(ask("form", { element }));
  if (!form) return;
  const field = form.fields.find((each) => each.feature === "name");
  if (!field?.changeable || form.readonly) {
    return say("What is selected has no name that can be changed here.");
  }
  const name = field.values[0] ?? "";
  if (partOf(key).of === "edge" || partOf(key).of === "group") {
    update({ dialog: { kind: "rename", element, name, base } });
  } else {
    update({ renaming: { key, element, name, base } });
  }
}

/** @param base Revision of which the ref is: that of when it was begun. */
export async function rename(
  element: Ref,
  before: string,
  name: string,
  base?: number,
): Promise<void> {
  update({ renaming: null, dialog: null });
  const { selection } = state();
  if (!name || name === before) return;
  if (!(await edit([{ kind: "rename", element, name }], `Rename ${before} to ${name}`, base)))
    return;
  // Names change the keys by which parts are found again, positions do not.
  const { graph } = state();
  if (graph && !state().selection.length) select(selection.filter((key) => has(graph, key)));
}
