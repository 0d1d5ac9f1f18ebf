// Changes of the model, and taking them back.

import type { Command, Corner, EditResult, KeptEdit } from "../protocol";
import { revisionOf, say, state, update } from "../store";
import { ask, openFor, tried } from "./asking";
import { choose } from "./choosing";
import { openFile, refresh } from "./showing";

let running: Promise<unknown> = Promise.resolve();

/** Resolves when the edits of this page are done: an offer made before one would take it back. */
export const idle = (): Promise<unknown> => running;

/**
 * Changes the model.
 *
 * @param base Revision of which the refs of the commands are: that of the answer that gave them; as
 *   a rule that of the graph, of which the choice is.
 * @param at Where the box of what is new shall stand.
 * @param isChosen Whether what is new is chosen then.
 * @throws CallError The server refused, and why.
 */
export async function change(
  commands: Command[],
  label: string,
  base = revisionOf(state()),
  at?: Corner,
  isChosen = true,
): Promise<EditResult> {
  const renames = commands.some((command) => command.kind === "rename");
  // The new graph may come before the answer, which the server tells everybody of.
  if (renames) update({ renames: state().renames + 1 });
  const { choice } = state();
  try {
    const asked = ask("edit", { commands, label, base, ...(at && { at }) });
    running = Promise.allSettled([running, asked]);
    const result = await asked;
    // Who has gone on to something else meanwhile stays there.
    return await settled(result, label, () => isChosen && state().choice === choice);
  } finally {
    if (renames) update({ renames: state().renames - 1 });
  }
}

/** Changes the model; null if the server refused, which the user is told. */
export async function edit(
  commands: Command[],
  label: string,
  base = revisionOf(state()),
  at?: Corner,
): Promise<EditResult | null> {
  return commands.length ? ((await tried(change(commands, label, base, at))) ?? null) : null;
}

/** Does an edit after all that was kept; what others have changed meanwhile gives way to it. */
export async function doAgain({ number, label }: KeptEdit): Promise<void> {
  const result = await tried(ask("kept.again", { number }));
  if (result) await settled(result, label);
}

/** Forgets an edit that was kept. */
export async function discard({ number, label }: KeptEdit): Promise<void> {
  if (await tried(ask("kept.discard", { number }))) say(`Discarded: ${label}`);
}

/** Shows what an edit did. */
export async function settled(
  result: EditResult,
  label: string,
  isChosen = () => true,
): Promise<EditResult> {
  say(label);
  if (state().revision < result.revision) await refresh();
  const created = result.created[0];
  if (created && isChosen()) choose(created);
  return result;
}

/** Asks for a new model. */
export async function beginModel(): Promise<void> {
  const asked = ask("starting_points", {});
  await openFor({ kind: "create", points: null }, asked, ({ points }) => ({
    kind: "create",
    points,
  }));
}

/** Makes a model file that begins with a starting point, and opens it. */
export async function newModel(file: string, origin: string): Promise<void> {
  const result = await tried(ask("create", { file, origin }));
  if (!result) return;
  await settled(result, `Create ${file}`);
  await openFile(file);
}

export async function undo(): Promise<void> {
  const result = await tried(ask("undo", {}));
  if (!result) return;
  say(result.entry ? `Undone: ${result.entry.label}` : "There is nothing to undo.");
  if (state().revision < result.revision) await refresh();
}

export async function redo(): Promise<void> {
  const result = await tried(ask("redo", {}));
  if (!result) return;
  say(result.entry ? `Done again: ${result.entry.label}` : "There is nothing to do again.");
  if (state().revision < result.revision) await refresh();
}
