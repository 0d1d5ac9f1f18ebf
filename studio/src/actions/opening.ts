// Dialogs that need an answer of the server.

import { type Dialog, state, update } from "../store";
import { tried } from "./asking";

/**
 * Opens a dialog at once, and fills it when the answer comes: what is typed meanwhile is for it, and
 * not for the diagram. The answer to a dialog that was closed or replaced meanwhile is not wanted.
 *
 * @param fill What the answer makes of the dialog, null to close it.
 */
export async function openFor<T>(
  dialog: Dialog,
  work: Promise<T>,
  fill: (answer: T) => Dialog | null,
): Promise<void> {
  update({ dialog });
  const answer = await tried(work);
  if (state().dialog === dialog) update({ dialog: answer === undefined ? null : fill(answer) });
}
