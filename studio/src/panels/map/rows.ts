import type { Graph, GraphEdge, GraphNode, MapSide, Ref } from "../../protocol";

/** What fills or reads a member. */
interface Use {
  edge: GraphEdge;
  element: Ref;
  /** How people read it: `-> pose.x: degrees_to_radians`. */
  text: string;
}

export interface MemberRow {
  node: string;
  path: string;
  label: string;
  note: string;
  mark: string;
  depth: number;
  hasInner: boolean;
  uses: Use[];
}

export interface SideRows {
  node: string;
  title: string;
  side: "jaus" | "ros";
  rows: MemberRow[];
}

/** Returns both ends of a map as rows, all members of them where the server tells them all. */
export function sides(graph: Graph, all: readonly MapSide[]): SideRows[] {
  return graph.nodes.map((node) => {
    const whole = all.find((side) => side.node === node.id);
    const marks = new Map(node.ports.map((port) => [port.id, port.mark]));
    const members = whole
      ? whole.members.map((member) => ({ ...member, mark: marks.get(member.path) ?? member.mark }))
      : node.ports.map((port) => ({ ...port, path: port.id }));
    const rows = members.map((member, index) => ({
      node: node.id,
      path: member.path,
      label: member.label,
      note: member.note,
      mark: member.mark,
      depth: member.depth,
      hasInner: (members[index + 1]?.depth ?? 0) > member.depth,
      uses: usesOf(graph, node, member.path),
    }));
    return { node: node.id, title: node.title, side: node.column === 0 ? "jaus" : "ros", rows };
  });
}

function usesOf(graph: Graph, node: GraphNode, path: string): Use[] {
  return graph.edges.flatMap((edge) => {
    const isTarget = edge.target.node === node.id && edge.target.port === path;
    const isSource = edge.source.node === node.id && edge.source.port === path;
    if (!isTarget && !isSource) return [];
    const other = isTarget ? edge.source.port : edge.target.port;
    const conversions = edge.labels.length > 0 ? `: ${edge.labels.join(", ")}` : "";
    const text = `${isTarget ? "←" : "→"} ${other || "all"}${conversions}`;
    return [{ edge, element: edge.element, text }];
  });
}

export type Filter = "all" | "mapped" | "unmapped";

/** Returns the rows to show: found by a query, and with all that they lie in open. */
export function shownRows(
  rows: readonly MemberRow[],
  query: string,
  filter: Filter,
  opened: ReadonlySet<string>,
) {
  const words = query.toLowerCase().split(/\s+/).filter(Boolean);
  const isWanted = (row: MemberRow) => {
    const text = `${row.path} ${row.note}`.toLowerCase();
    const isUsed = row.uses.length > 0 || row.mark.startsWith("=") || row.mark === "ignored";
    return (
      words.every((word) => text.includes(word)) &&
      (filter === "all" || (filter === "mapped") === isUsed)
    );
  };
  if (words.length > 0 || filter !== "all") return rows.filter(isWanted);
  let closedAt = Number.POSITIVE_INFINITY;
  return rows.filter((row) => {
    if (row.depth > closedAt) return false;
    closedAt = row.hasInner && !opened.has(row.path) ? row.depth : Number.POSITIVE_INFINITY;
    return true;
  });
}

/** Returns the members that are open at first: those with something mapped within. */
export function openAtFirst(rows: readonly MemberRow[]): Set<string> {
  const used = rows.filter(
    (row) => row.uses.length > 0 || row.mark.startsWith("=") || row.mark === "ignored",
  );
  return new Set(
    rows
      .filter((row) => row.hasInner && used.some((other) => other.path.startsWith(`${row.path}.`)))
      .map((row) => row.path),
  );
}
