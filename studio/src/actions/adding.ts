// Adding what the palette offers.

import type { PaletteItem, Point } from "../protocol";
import { state } from "../store";
import { edit } from "./changing";
import { place } from "./placing";

/** Type of what the palette gives to a drag: the item as JSON. */
export const DRAGGED = "application/x-jausml-palette-item";

/** Adds what an item of the palette holds, where it was dropped if it was dropped. */
export async function drop(item: PaletteItem, at: Point | null = null): Promise<void> {
  const result = await edit(item.drop.commands, item.label_of_edit);
  if (!result || !at) return;
  const { graph } = state();
  const created = new Set(result.created);
  const node = graph?.nodes.find((each) => created.has(each.element));
  if (node) await place({ [node.key]: [Math.round(at[0]), Math.round(at[1])] });
}
