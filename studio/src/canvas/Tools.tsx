import { useReactFlow } from "@xyflow/react";
import { type KeyboardEvent, useEffect } from "react";
import { arrange, filterBy, focusOn, removeSelected, select } from "../actions";
import type { Graph } from "../protocol";
import { state, useStudio } from "../store";
import { matches } from "./following";

/** The tools above the diagram cover none of it. */
export const FIT = {
  padding: { top: "44px", right: 0.07, bottom: 0.05, left: 0.07 },
  maxZoom: 1.2,
} as const;

/** Name of the event by which keys of the page ask the diagram to fit. */
export const FIT_EVENT = "studio-fit";

/** What can be done with the diagram as a whole. */
export function Tools({ graph }: { graph: Graph }) {
  const flow = useReactFlow();
  const filter = useStudio((studio) => studio.filter);
  const isFocused = useStudio((studio) => studio.bright !== null && !studio.filter);
  const isChosen = useStudio((studio) => studio.selection.length > 0);
  const found = filter ? matches(graph, filter) : [];

  useEffect(() => {
    const fit = () => void flow.fitView(FIT);
    document.addEventListener(FIT_EVENT, fit);
    return () => document.removeEventListener(FIT_EVENT, fit);
  }, [flow]);

  function onFilterKey(event: KeyboardEvent) {
    if (event.key === "Escape") {
      filterBy("");
      document.querySelector<HTMLElement>(".flow")?.focus();
    }
    if (event.key !== "Enter" || !found.length) return;
    const at = found.indexOf(state().selection.at(-1) ?? "");
    const next = found.at((at + (event.shiftKey ? -1 : 1)) % found.length);
    if (next) select([next]);
  }

  return (
    <div className="tools" role="toolbar" aria-label="Diagram">
      <input
        id="filter"
        type="search"
        placeholder="Filter by name"
        aria-label="Filter by name"
        title="Ctrl+F; Enter goes to the next that fits"
        spellCheck={false}
        value={filter}
        onChange={(event) => filterBy(event.currentTarget.value)}
        onKeyDown={onFilterKey}
      />
      {filter && <output>{found.length} fit</output>}
      <button type="button" onClick={() => void flow.fitView(FIT)} title="Show all (0)">
        Fit
      </button>
      <button type="button" onClick={() => void flow.zoomIn()} aria-label="Larger" title="+">
        +
      </button>
      <button type="button" onClick={() => void flow.zoomOut()} aria-label="Smaller" title="-">
        −
      </button>
      <button type="button" onClick={() => void arrange()} title="Place all boxes anew (a)">
        Arrange
      </button>
      <button
        type="button"
        aria-pressed={isFocused}
        disabled={!isFocused && !isChosen}
        onClick={() => focusOn(isFocused ? null : "both")}
        title="Only what is up- and downstream of the choice (o; u: upstream, d: downstream)"
      >
        Focus
      </button>
      <button
        type="button"
        disabled={!isChosen}
        onClick={() => void removeSelected()}
        title="Delete"
      >
        Delete
      </button>
    </div>
  );
}
