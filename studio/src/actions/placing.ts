// Where boxes stand.

import type { EditResult, LayoutKey, Point } from "../protocol";
import { say, state } from "../store";
import { ask, tried } from "./asking";
import { edit } from "./changing";
import { show } from "./showing";

/** Keeps boxes of the view where the user put them. */
export function place(positions: Record<LayoutKey, Point>): Promise<EditResult | null> {
  const count = Object.keys(positions).length;
  const label = count === 1 ? "Move a box" : `Move ${count} boxes`;
  return edit([{ kind: "place", file: state().file, view: state().view, positions }], label);
}

/** Lets the layout place every box anew. */
export async function arrange(): Promise<void> {
  const { file, view } = state();
  const answer = await tried(ask("arrange", { file, view }));
  if (!answer || state().view !== view) return;
  show(answer.graph, answer.revision);
  say("Arranged.");
}
