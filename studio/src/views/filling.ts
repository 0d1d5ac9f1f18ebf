// Filling a map from what corresponds.

import { ask, change, fitAll, messageOf } from "../actions";
import type { Filling } from "../protocol";
import { say, state } from "../store";

/** Fills what nothing fills yet in the map that is shown; null if nothing was done, and says why. */
export async function fillMap(): Promise<Filling | null> {
  const { file, view } = state();
  if (!mayFill()) return null;
  try {
    const filling = await ask("fill_map", { file, view });
    if (filling.refusal) {
      say(filling.refusal);
      return filling;
    }
    await change(filling.commands, filling.label, filling.revision);
    // Boxes have grown by the rows that are shown now.
    fitAll();
    return filling;
  } catch (error) {
    say(messageOf(error), true);
    return null;
  }
}

/** Whether a map is shown that may be changed. */
export function mayFill(): boolean {
  const { view, views } = state();
  return view.startsWith("map:") && !views.find((each) => each.name === view)?.library;
}

/** Name of the event by which a key asks to fill the map. */
export const FILL_EVENT = "studio-fill";
