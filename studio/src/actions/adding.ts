// Adding what the palette offers.

import type { PaletteItem, Point, Ref } from "../protocol";
import { state } from "../store";
import { ask, tried } from "./asking";
import { edit } from "./changing";

/** Type of what the palette gives to a drag: the item as JSON. */
export const DRAGGED = "application/x-jausml-palette-item";

/**
 * Adds what an item of the palette holds.
 *
 * @param at Where it was dropped, null if it was not.
 * @param onto The element on which it was dropped; what does not fit there goes into the system.
 */
export async function drop(
  item: PaletteItem,
  at: Point | null = null,
  onto: Ref | "" = "",
): Promise<void> {
  const meant = await fitting(item, onto);
  if (!meant) return;
  const { item: chosen, base } = meant;
  const { file, view } = state();
  const corner = at && { file, view, x: Math.round(at[0]), y: Math.round(at[1]) };
  await edit(chosen.commands, chosen.label_of_edit, base, corner ?? undefined);
}

/**
 * The item as it goes on what it was dropped on (dragged was what went on the choice), with the
 * revision of its refs.
 */
async function fitting(item: PaletteItem, onto: Ref | "") {
  if (!onto && !item.onto) return { item };
  const { file } = state();
  const { label: query, group } = item;
  const answer = await tried(ask("palette", { file, query, kinds: [group], onto }));
  if (!answer) return undefined;
  const offered = answer.items.find((candidate) => candidate.id === item.id);
  return offered ? { item: offered, ...(answer.revision && { base: answer.revision }) } : { item };
}
