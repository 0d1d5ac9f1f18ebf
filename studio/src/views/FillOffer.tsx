import { useCallback, useEffect, useState } from "react";
import { ask, change, fitAll, messageOf } from "../actions";
import type { Filling } from "../protocol";
import { type Studio, say, state, update, useStudio } from "../store";

const MOST = 8;

/** Offers to fill a map from what corresponds, and tells what is left to its author. */
export function FillOffer() {
  const isEmpty = useStudio((studio) => studio.graph !== null && studio.graph.edges.length === 0);
  const [last, setLast] = useState<{ filling: Filling; picture: string } | null>(null);
  // What was left may be filled as soon as anything has changed since.
  const picture = useStudio(pictureOf);
  const filled = last?.picture === picture ? last.filling : null;
  const fill = useCallback(async () => {
    const filling = await fillMap();
    setLast(filling && { filling, picture: pictureOf(state()) });
  }, []);

  useEffect(() => {
    document.addEventListener(FILL_EVENT, fill);
    return () => document.removeEventListener(FILL_EVENT, fill);
  }, [fill]);

  return (
    <>
      <button
        type="button"
        className={isEmpty ? "best" : ""}
        title="By names, times, orientations, units and axes, with the conversions that the rules accept (m)"
        onClick={() => void fill()}
      >
        Fill what corresponds
      </button>
      <span role="status">{filled ? toldOf(filled) : isEmpty ? "This map is empty." : ""}</span>
      {filled && leftOf(filled).length > 0 && (
        <button type="button" className="link" onClick={() => update({ middle: "members" })}>
          Show all members
        </button>
      )}
    </>
  );
}

const pictureOf = ({ file, view, revision }: Studio) => `${file} ${view} ${revision}`;

function leftOf({ left }: Filling): string[] {
  return [...(left.to_ros ?? []), ...(left.to_jaus ?? [])];
}

function toldOf(filling: Filling): string {
  const count = filling.commands.length;
  const done = filling.refusal
    ? `Nothing was filled: ${filling.refusal}.`
    : `${count} assignment${count === 1 ? " was" : "s were"} added; undo takes them back.`;
  const left = leftOf(filling);
  if (left.length === 0) return `${done} No member is left.`;
  const more = left.length > MOST ? ` and ${left.length - MOST} more` : "";
  return `${done} Left to you: ${left.slice(0, MOST).join(", ")}${more}.`;
}

/** Fills what nothing fills yet in the map that is shown; null if nothing was done, and says why. */
async function fillMap(): Promise<Filling | null> {
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
function mayFill(): boolean {
  const { view, views } = state();
  return view.startsWith("map:") && !views.find((candidate) => candidate.name === view)?.library;
}

/** Name of the event by which a key asks to fill the map. */
export const FILL_EVENT = "studio-fill";
