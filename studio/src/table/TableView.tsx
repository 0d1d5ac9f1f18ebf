import { type KeyboardEvent, useMemo, useState } from "react";
import { select } from "../actions";
import { liveText, Mark, severityOf, told } from "../canvas/marks";
import { isTyping, nameOfKey } from "../keyboard/keys";
import { PART_KEYS, press } from "../keyboard/partKeys";
import type { Graph, LiveState } from "../protocol";
import { useStudio } from "../store";
import { boxRows, type Column, lineRows, type Row, sorted } from "./rows";

/** The same graph in tables: for screen readers, for print, and to sort. */
export function TableView() {
  const graph = useStudio((studio) => studio.graph);
  const fault = useStudio((studio) => studio.graphFault);
  if (!graph) return <p className="quiet">{fault || "Nothing to show yet."}</p>;
  return <Tables graph={graph} />;
}

function Tables({ graph }: { graph: Graph }) {
  const lines = useMemo(() => lineRows(graph), [graph]);
  const boxes = useMemo(() => boxRows(graph), [graph]);
  return (
    <div className="sheet">
      <Sheet caption={`Lines of ${graph.title || graph.view}`} columns={LINES} rows={lines} />
      <Sheet caption={`Boxes and their rows`} columns={BOXES} rows={boxes} />
    </div>
  );
}

const LINES: Column[] = ["from", "what", "to", "kind", "with"];
const BOXES: Column[] = ["box", "row", "kind", "with"];

const TITLES: Record<Column, string> = {
  from: "From",
  what: "What flows",
  to: "To",
  kind: "Kind",
  with: "With",
  box: "Box",
  row: "Row",
};

interface Order {
  column: Column;
  isUp: boolean;
}

function Sheet({ caption, columns, rows }: { caption: string; columns: Column[]; rows: Row[] }) {
  const [order, setOrder] = useState<Order | null>(null);
  const selection = useStudio((studio) => studio.selection);
  const bright = useStudio((studio) => studio.bright);
  const live = useStudio((studio) => studio.live);
  const shown = useMemo(
    () => (order ? sorted(rows, order.column, order.isUp) : rows),
    [rows, order],
  );
  const last = selection.at(-1);
  const at = Math.max(
    0,
    shown.findIndex((row) => row.key === last),
  );

  function onKeyDown(event: KeyboardEvent<HTMLTableSectionElement>) {
    if (isTyping(event.nativeEvent)) return;
    const name = nameOfKey(event);
    const to = { ArrowDown: at + 1, ArrowUp: at - 1, Home: 0, End: shown.length - 1 }[name];
    const row = to === undefined ? undefined : shown[to];
    const doing = PART_KEYS[name];
    if (to === undefined && !doing) return;
    event.preventDefault();
    if (row) {
      select([row.key]);
      event.currentTarget.querySelectorAll<HTMLElement>("tr")[to ?? 0]?.focus();
    } else if (doing) press(doing);
  }

  function sortBy(column: Column) {
    setOrder((before) => ({ column, isUp: before?.column === column ? !before.isUp : true }));
  }

  return (
    <table>
      <caption>{caption}</caption>
      <thead>
        <tr>
          {columns.map((column) => (
            <th key={column} scope="col" aria-sort={sortOf(order, column)}>
              <button type="button" onClick={() => sortBy(column)}>
                {TITLES[column]}
                <span aria-hidden="true">{arrowOf(order, column)}</span>
              </button>
            </th>
          ))}
          <th scope="col">Problems</th>
          {live && <th scope="col">Live</th>}
        </tr>
      </thead>
      <tbody onKeyDown={onKeyDown}>
        {shown.map((row, index) => (
          <tr
            key={row.key}
            className={`${selection.includes(row.key) ? "chosen" : ""} ${bright && !bright.has(row.key) ? "dim" : ""}`}
            tabIndex={index === at ? 0 : -1}
            aria-current={row.key === last ? "true" : undefined}
            onClick={() => select([row.key])}
            onFocus={() => row.key !== last && select([row.key])}
          >
            {columns.map((column) => (
              <td key={column}>{row.cells[column]}</td>
            ))}
            <td className={severityOf(row.findings)}>
              <Mark findings={row.findings} /> {told(row.findings)}
            </td>
            {live && <td>{liveOf(live, row)}</td>}
          </tr>
        ))}
      </tbody>
    </table>
  );
}

function liveOf(live: LiveState, row: Row): string {
  const state = live.edges[row.id] ?? live.boxes[row.id];
  return state ? liveText(state) : "";
}

function sortOf(order: Order | null, column: Column) {
  if (order?.column !== column) return "none";
  return order.isUp ? "ascending" : "descending";
}

function arrowOf(order: Order | null, column: Column): string {
  if (order?.column !== column) return "";
  return order.isUp ? " ▲" : " ▼";
}
