// Removing elements.

import type { Command, Ref } from "../protocol";
import { partOf } from "../selection";
import { active, revisionOf, say, state, update } from "../store";
import { ask, tried } from "./asking";
import { dryRun, edit } from "./changing";
import { selected } from "./choosing";

/** Removes elements; asks first where others refer to them. */
export async function remove(elements: Ref[], what: string): Promise<void> {
  const commands: Command[] = elements.map((element) => ({ kind: "remove", element }));
  if (!commands.length) return;
  const label = `Remove ${what}`;
  const base = revisionOf(state());
  const dry = await dryRun(commands, label);
  if (!dry) return;
  const referrers = dry.referrers ?? [];
  if (!referrers.length) {
    await edit(commands, label, base);
    return;
  }
  update({ dialog: { kind: "delete", commands, label, referrers, diff: dry.diff ?? "", base } });
}

/** Removes what is selected. */
export async function removeSelected(): Promise<void> {
  const { elements, what } = selected();
  if (elements.length) return remove(elements, what);
  const key = active(state());
  const part = key ? partOf(key) : null;
  if (part?.of === "edge") return unlink(part.id);
  say("Nothing is selected that could be removed.");
}

/** Takes a line away that is no element, such as one that shows a reference. */
async function unlink(line: string): Promise<void> {
  const { file, view } = state();
  const answer = await tried(ask("unlink", { file, view, line }));
  const [option] = answer?.options ?? [];
  if (option) await edit(option.commands, option.label, answer?.revision);
  else if (answer) say(answer.refusal);
}
