// Connecting two ends, by a line that is drawn or by a search.

import { flushSync } from "react-dom";
import { keyOfEnd } from "../canvas/navigation";
import type { ConnectOption, GraphEnd } from "../protocol";
import { type PartKey, partOf } from "../selection";
import { active, say, state, update } from "../store";
import { ask, tried } from "./asking";
import { edit } from "./changing";

/** Offers how two ends may be connected. */
export async function connect(source: GraphEnd, target: GraphEnd): Promise<void> {
  const { file, view } = state();
  const answer = await tried(ask("connect", { file, view, source, target }));
  if (answer) update({ dialog: { kind: "connect", source, target, ...answer } });
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
  // It is there at once: what is typed before the answer comes is for it, and not for the diagram.
  const dialog = { kind: "ends" as const, from, ends: null };
  flushSync(() => update({ dialog }));
  const answer = await tried(ask("ends", { file, view, ...from }));
  if (state().dialog !== dialog) return;
  update({ dialog: answer ? { ...dialog, ends: answer.ends } : null });
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
