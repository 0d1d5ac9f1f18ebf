// Giving elements other names.

import type { Form, Ref } from "../protocol";
import { elementOf, partOf } from "../selection";
import { active, revisionOf, say, state, update } from "../store";
import { ask, openFor, tried } from "./asking";
import { edit } from "./changing";

/** Begins to rename what the keyboard stands on. */
export async function beginRename(key = active(state())): Promise<void> {
  const { graph } = state();
  const element = graph && key ? elementOf(graph, key) : "";
  if (!key || !element) return say("What is selected has no name to change.");
  const base = revisionOf(state());
  const asked = ask("form", { element });
  if (partOf(key).of === "edge" || partOf(key).of === "group") {
    const dialog = { kind: "rename" as const, element, name: null, base };
    await openFor(dialog, asked, (form) => {
      const name = nameIn(form);
      return name === null ? null : { ...dialog, name };
    });
    return;
  }
  const renaming = { key, element, name: null, base };
  update({ renaming });
  const form = await tried(asked);
  if (state().renaming !== renaming) return; // it was left meanwhile
  const name = form ? nameIn(form) : null;
  update({ renaming: name === null ? null : { ...renaming, name } });
}

/** The name that a form lets one change; null where there is none, which the user is told. */
function nameIn(form: Form): string | null {
  const field = form.fields.find((candidate) => candidate.feature === "name");
  if (field?.changeable && !form.readonly) return field.values[0] ?? "";
  say("What is selected has no name that can be changed here.");
  return null;
}

/** @param base Revision of which the ref is: that of when it was begun. */
export async function rename(
  element: Ref,
  before: string,
  name: string,
  base?: number,
): Promise<void> {
  update({ renaming: null, dialog: null });
  if (!name || name === before) return;
  await edit([{ kind: "rename", element, name }], `Rename ${before} to ${name}`, base);
}
