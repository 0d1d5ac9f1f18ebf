// Copying, cutting and pasting: as text, which goes by the clipboard of the system.

import { say, state, update } from "../store";
import { ask, tried } from "./asking";
import { settled } from "./changing";
import { selected } from "./choosing";
import { keepDraft } from "./drafting";
import { removeSelected } from "./removing";

export async function copySelected(): Promise<boolean> {
  const { elements, what } = selected();
  if (!elements.length) {
    say("Nothing is selected that could be copied.");
    return false;
  }
  const answer = await tried(ask("copy", { elements }));
  if (!answer) return false;
  // A page of another computer may have no clipboard but its own.
  const isTaken = await takenBySystem(answer.text);
  update({ clip: isTaken ? "" : answer.text });
  say(isTaken ? `Copied ${what}.` : `Copied ${what}, for this page alone.`);
  return true;
}

async function takenBySystem(text: string): Promise<boolean> {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    return false;
  }
}

export async function cutSelected(): Promise<void> {
  const { choice } = state();
  // What was chosen while the browser asked for its clipboard was not copied.
  if ((await copySelected()) && state().choice === choice) await removeSelected();
}

/**
 * Pastes into what is chosen, or beside it; the server finds the owner that fits.
 *
 * @param text What the clipboard of the system has.
 */
export async function paste(text: string): Promise<void> {
  const { clip, chosen, file } = state();
  const meant = clip || text;
  if (!meant.trim()) return say("Nothing was copied.");
  const owner = chosen || `${file}#/`;
  const result = await tried(ask("paste", { owner, text: meant }));
  if (!result) return;
  await settled(result, "Paste");
  const { left_out, created } = result;
  if (!left_out.length) return;
  const what = left_out.map(({ name, message }) => (name ? `${name}: ${message}` : message));
  keepDraft({
    element: created[0] ?? "",
    field: "pasted",
    what: what.join("; "),
    text: "",
    why: "What is missing here was left out",
  });
}
