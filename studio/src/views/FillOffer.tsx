import { useCallback, useEffect, useState } from "react";
import type { Filling } from "../protocol";
import { type Studio, state, update, useStudio } from "../store";
import { FILL_EVENT, fillMap } from "./filling";

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
