// Removing elements.

import type { Command, Ref } from "../protocol";
import { partOf } from "../selection";
import { active, revisionOf, say, state } from "../store";
import { ask, openFor, tried } from "./asking";
import { edit } from "./changing";
import { selected } from "./choosing";

/**
 * Removes elements; asks first where others refer to them.
 *
 * @param base Revision of which their refs are.
 */
export async function remove(
  elements: Ref[],
  what: string,
  base = revisionOf(state()),
): Promise<void> {
  const commands: Command[] = elements.map((element) => ({ kind: "remove", element }));
  if (!commands.length) return;
  const label = `Remove ${what}`;
  const dialog = { kind: "delete" as const, commands, label, referrers: null, diff: "", base };
  let isDone = false;
  await openFor(dialog, ask("edit", { commands, label, dry: true, base }), (dry) => {
    isDone = !dry.referrers?.length;
    return isDone ? null : { ...dialog, referrers: dry.referrers ?? [], diff: dry.diff ?? "" };
  });
  if (isDone) await edit(commands, label, base);
}

/** A row that says that a component provides or uses a service, which stands elsewhere. */
const IS_USE = /!(provides|uses)!/;

/** Removes what is selected: of a use that alone, and not the service. */
export async function removeSelected(): Promise<void> {
  const { selection } = state();
  const key = active(state());
  const part = key ? partOf(key) : null;
  const uses = selection.filter((key) => key.startsWith("port") && IS_USE.test(partOf(key).id));
  const { elements, what } = selected(selection.filter((key) => !uses.includes(key)));
  // Those of now, as rows that go give the choice to their boxes.
  const base = revisionOf(state());
  for (const use of uses) await unlink(partOf(use).id);
  if (elements.length) return remove(elements, what, base);
  if (uses.length) return;
  if (part?.of === "edge") return unlink(part.id);
  say("Nothing is selected that could be removed.");
}

/** Takes a line or row away that is no element, such as one that shows a reference. */
async function unlink(line: string): Promise<void> {
  const answer = await tried(ask("unlink", { file: state().file, line }));
  const [option] = answer?.options ?? [];
  if (option) await edit(option.commands, option.label, answer?.revision);
  else if (answer) say(answer.refusal);
}
