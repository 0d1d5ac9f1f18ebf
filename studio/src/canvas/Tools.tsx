import { useReactFlow } from "@xyflow/react";
import type { ButtonHTMLAttributes, KeyboardEvent } from "react";
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
  const matching = filter ? matches(graph, filter) : [];

  function onFilterKey(event: KeyboardEvent) {
    if (event.key === "Escape") {
      filterBy("");
      document.querySelector<HTMLElement>(".flow")?.focus();
    }
    if (event.key !== "Enter" || !matching.length) return;
    const at = matching.indexOf(state().selection.at(-1) ?? "");
    const next = matching.at((at + (event.shiftKey ? -1 : 1)) % matching.length);
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
      {filter && <output>{matching.length} fit</output>}
      {tool("Fit", "Show all (0)", fitAll)}
      {tool("+", "+", () => void flow.zoomIn(), { "aria-label": "Larger" })}
      {tool("−", "-", () => void flow.zoomOut(), { "aria-label": "Smaller" })}
      {tool("Arrange", "Place all boxes anew (a)", () => void arrange())}
      {graph.nodes.length > FEW_BOXES &&
        tool("Map", "A map of the diagram, where not all of it is in sight", () => onMap(!hasMap), {
          "aria-pressed": hasMap,
        })}
      {isService &&
        tool(
          "Bodies",
          "The fields of the messages that the service itself defines",
          () => void openView(graph.view.replace(/^\w+/, hasBodies ? SERVICE : BODIES)),
          { "aria-pressed": hasBodies },
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
      {tool(
        "Connect…",
        "Search an end to connect the chosen box or row with (c)",
        () => void offerEnds(),
        { disabled: !isEnd },
      )}
      {tool(
        "Focus",
        "Only what is up- and downstream of the choice (o; u: upstream, d: downstream)",
        () => focusOn(isFocused ? null : "both"),
        { "aria-pressed": isFocused, disabled: !isFocused && !isChosen },
      )}
      {tool("Delete", "Delete", () => void removeSelected(), { disabled: !isChosen })}
    </div>
  );
}

const tool = (
  name: string,
  title: string,
  onClick: () => void,
  more: ButtonHTMLAttributes<HTMLButtonElement> = {},
) => (
  <button type="button" title={title} onClick={onClick} {...more}>
    {name}
  </button>
);
