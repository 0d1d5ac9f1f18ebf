// Rows of the tables of a graph.

import type { Finding, Graph, GraphEnd } from "../protocol";
import { edgeKey, indexOf, nodeKey, type PartKey, portKey } from "../selection";

export type Column = "from" | "what" | "to" | "kind" | "with" | "box" | "row";

export interface Row {
  key: PartKey;
  /** Id by which live values know it. */
  id: string;
  cells: Partial<Record<Column, string>>;
  findings: readonly Finding[];
}

/** A row for each line. */
export function lineRows(graph: Graph): Row[] {
  return graph.edges.map((edge) => ({
    key: edgeKey(edge.id),
    id: edge.id,
    cells: {
      from: endName(graph, edge.source),
      what: edge.title,
      to: endName(graph, edge.target),
      kind: edge.count > 1 ? `${edge.count} × ${edge.kind}` : edge.kind,
      with: edge.labels.filter((label) => label !== edge.title).join(", "),
    },
    findings: edge.findings,
  }));
}

/** A row for each box, and one for each of its rows. */
export function boxRows(graph: Graph): Row[] {
  return graph.nodes.flatMap((node) => [
    {
      key: nodeKey(node.id),
      id: node.id,
      cells: { box: node.title, row: "", kind: node.kind, with: node.subtitle.join(", ") },
      findings: node.findings,
    },
    ...node.ports.map((port) => ({
      key: portKey(node.id, port.id),
      id: port.id,
      cells: {
        box: node.title,
        row: `${"  ".repeat(port.depth)}${port.label}`,
        kind: "row",
        with: [port.note, port.mark].filter(Boolean).join(", "),
      },
      findings: port.findings,
    })),
  ]);
}

function endName(graph: Graph, end: GraphEnd): string {
  const node = indexOf(graph).nodes.get(end.node);
  const port = node?.ports.find((candidate) => candidate.id === end.port);
  return [node?.title ?? "", port?.label ?? ""].filter(Boolean).join(" · ");
}

const COLLATOR = new Intl.Collator("en", { numeric: true, sensitivity: "base" });

/** Rows by a column; equal ones keep their order. */
export function sorted(rows: readonly Row[], column: Column, isUp: boolean): Row[] {
  const sign = isUp ? 1 : -1;
  return [...rows].sort(
    (a, b) => sign * COLLATOR.compare(a.cells[column] ?? "", b.cells[column] ?? ""),
  );
}
