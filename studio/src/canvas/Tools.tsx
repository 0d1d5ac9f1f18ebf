import { useReactFlow } from "@xyflow/react";
import type { KeyboardEvent } from "react";
import {
  arrange,
  endOf,
  exportPicture,
  filterBy,
  fitAll,
  focusOn,
  offerEnds,
  openView,
  type PictureFormat,
  removeSelected,
  select,
} from "../actions";
import type { Graph } from "../protocol";
import { active, state, useStudio } from "../store";
import { matches } from "./following";

/** Kinds of views of a service, without and with bodies of messages. */
export const [SERVICE, BODIES] = ["service", "bodies"];

/** A diagram of more boxes has a map. */
export const FEW_BOXES = 8;

export interface ToolsProps {
  graph: Graph;
  /** Whether a large diagram has a map where not all of it is in sight. */
  hasMap: boolean;
  onMap: (isShown: boolean) => void;
}

/** What can be done with the diagram as a whole. */
export function Tools({ graph, hasMap, onMap }: ToolsProps) {
  const flow = useReactFlow();
  const filter = useStudio((studio) => studio.filter);
  const isFocused = useStudio((studio) => studio.bright !== null && !studio.filter);
  const isChosen = useStudio((studio) => studio.selection.length > 0);
  const isEnd = useStudio((studio) => {
    const here = active(studio);
    return here !== null && endOf(here) !== null;
  });
  const hasBodies = graph.view.startsWith(`${BODIES}:`);
  const isService = hasBodies || graph.view.startsWith(`${SERVICE}:`);
  const found = filter ? matches(graph, filter) : [];

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
        spellCheck="false"
        value={filter}
        onChange={(event) => filterBy(event.currentTarget.value)}
        onKeyDown={onFilterKey}
      />
      {filter && <output>{found.length} fit</output>}
      <button type="button" onClick={fitAll} title="Show all (0)">
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
      {graph.nodes.length > FEW_BOXES && (
        <button
          type="button"
          aria-pressed={hasMap}
          onClick={() => onMap(!hasMap)}
          title="A map of the diagram, where not all of it is in sight"
        >
          Map
        </button>
      )}
      {isService && (
        <button
          type="button"
          aria-pressed={hasBodies}
          onClick={() => void openView(graph.view.replace(/^\w+/, hasBodies ? SERVICE : BODIES))}
          title="The fields of the messages that the service itself defines"
        >
          Bodies
        </button>
      )}
      <select
        aria-label="Export the diagram"
        title="Save the whole diagram as jausml diagram draws it"
        onChange={({ currentTarget }) => {
          void exportPicture(currentTarget.value as PictureFormat);
          currentTarget.value = ""; // the same may be wanted again
        }}
      >
        <option value="">Export…</option>
        <option value="svg">SVG</option>
        <option value="png">PNG</option>
      </select>
      <button
        type="button"
        disabled={!isEnd}
        onClick={() => void offerEnds()}
        title="Search an end to connect the chosen box or row with (c)"
      >
        Connect…
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
