// Connecting two ends, by a line that is drawn or by a search.

import { keyOfEnd } from "../canvas/navigation";
import type { ConnectOption, GraphEnd, LegalEnd } from "../protocol";
import { type PartKey, partOf } from "../selection";
import { active, say, state, update } from "../store";
import { ask, openFor } from "./asking";
import { edit, idle } from "./changing";

/** Offers how two ends may be connected. */
export async function connect(source: GraphEnd, target: GraphEnd): Promise<void> {
  const { file, view } = state();
  const dialog = { kind: "connect" as const, source, target, options: null, refusal: "" };
  const asked = idle().then(() => ask("connect", { file, view, source, target }));
  await openFor(dialog, asked, (answer) => ({
    ...dialog,
    ...answer,
  }));
}

export async function take(option: ConnectOption, base?: number): Promise<void> {
  update({ dialog: null });
  await edit(option.commands, option.label, base);
}

/** Offers the ends that what the keyboard stands on can be connected to. */
export async function offerEnds(key = active(state())): Promise<void> {
  const from = key ? endOf(key) : null;
  if (!from) return say("Choose a box or a row first.");
  const { file, view } = state();
  const dialog = { kind: "ends" as const, from, ends: null };
  const fill = ({ ends }: { ends: LegalEnd[] }) => ({ ...dialog, ends });
  await openFor(dialog, ask("ends", { file, view, ...from }), fill);
}

export function endOf(key: PartKey): GraphEnd | null {
  const part = partOf(key);
  if (part.of === "node") return { node: part.id, port: "" };
  return part.of === "port" ? { node: part.node, port: part.id } : null;
}

let drawings = 0;

/** Shows where a line that begins at an end may end, until `endDrawing`. */
export async function beginDrawing(from: GraphEnd): Promise<void> {
  const { file, view, graph } = state();
  const drawing = ++drawings;
  // Without an answer the line can still be drawn; the server judges it then.
  const answer = await ask("ends", { file, view, ...from }).catch(() => null);
  if (!answer || !graph || drawing !== drawings) return;
  update({ legal: new Set(answer.ends.map((end) => keyOfEnd(graph, end))) });
}

export function endDrawing(): void {
  drawings++;
  update({ legal: null });
}
