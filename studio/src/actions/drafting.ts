// What was typed and could not be taken: it waits for its field, or for being discarded.

import type { Ref } from "../protocol";
import { type Draft, state, update } from "../store";

function others(element: Ref | "", field: string): Draft[] {
  return state().drafts.filter((draft) => draft.element !== element || draft.field !== field);
}

/** Keeps what was typed; what was kept for the same field before gives way. */
export function keepDraft(draft: Draft): void {
  update({ drafts: [...others(draft.element, draft.field), draft] });
}

export function draftOf(element: Ref | "", field: string): Draft | undefined {
  return state().drafts.find((draft) => draft.element === element && draft.field === field);
}

export function dropDraft(element: Ref | "", field: string): void {
  if (draftOf(element, field)) update({ drafts: others(element, field) });
}
