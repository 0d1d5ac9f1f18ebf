// Copying, cutting and pasting.

import { say, state, update } from "../store";
import { ask, tried } from "./asking";
import { settled } from "./changing";
import { selected } from "./choosing";
import { removeSelected } from "./removing";

export async function copySelected(): Promise<boolean> {
  const { elements, what } = selected();
  if (!elements.length) {
    say("Nothing is selected that could be copied.");
    return false;
  }
  const answer = await tried(ask("copy", { elements }));
  if (!answer) return false;
  update({ clip: answer.commands });
  say(`Copied ${what}.`);
  return true;
}

export async function cutSelected(): Promise<void> {
  if (await copySelected()) await removeSelected();
}

/** Pastes into what is chosen, or beside it; the server finds the owner that fits. */
export async function paste(): Promise<void> {
  const { clip, chosen, file } = state();
  if (!clip.length) return say("Nothing was copied.");
  const owner = chosen || `${file}#/`;
  const result = await tried(ask("paste", { owner, commands: clip }));
  if (result) await settled(result, "Paste");
}
