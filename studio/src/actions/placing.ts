// Where boxes stand.

import { boxesOf, hostsOf } from "../canvas/frames";
import type { Command, EditResult, LayoutKey, Point } from "../protocol";
import { say, state, update } from "../store";
import { ask, tried } from "./asking";
import { edit } from "./changing";
import { fitAll, takePicture } from "./showing";

/** Keeps boxes of a view, by default of that which is shown, where the user put them. */
export function place(
  positions: Record<LayoutKey, Point>,
  { file, view }: { file: string; view: string } = state(),
): Promise<EditResult | null> {
  const count = Object.keys(positions).length;
  const label = count === 1 ? "Move a box" : `Move ${count} boxes`;
  return edit([{ kind: "place", file, view, positions }], label);
}

/**
 * Keeps boxes where they were dragged, into the frame of another host: they run there then.
 *
 * @param host Id of the frame, empty for outside of all.
 */
export async function placeOn(
  host: string,
  boxes: string[],
  positions: Record<LayoutKey, Point>,
): Promise<EditResult | null> {
  const { file, view } = state();
  const option = await tried(ask("host", { file, nodes: boxes, host }));
  if (!option) return null;
  const placed: Command[] = Object.keys(positions).length
    ? [{ kind: "place", file, view, positions }]
    : [];
  if (!option.commands.length) return placed.length ? place(positions, { file, view }) : null;
  return edit([...option.commands, ...placed], option.label, option.revision);
}

/** Asks on which host the chosen boxes shall run. */
export function offerHosts(): void {
  const { graph, selection } = state();
  const boxes = graph ? boxesOf(graph, selection) : [];
  if (!graph || hostsOf(graph).length === 0) return say("The system has no hosts.");
  if (!boxes.length) return say("Choose a component or a node first.");
  update({ dialog: { kind: "hosts", boxes } });
}

/** Lets the layout place every box anew. */
export async function arrange(): Promise<void> {
  const { file, view, opened } = state();
  const answer = await tried(ask("arrange", { file, view, opened }));
  if (!answer || state().file !== file || state().view !== view) return;
  takePicture(answer);
  fitAll();
  say("Arranged.");
}
