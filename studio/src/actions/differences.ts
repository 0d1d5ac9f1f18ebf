// Pictures of differences: parts that have not changed stay the same objects, and are not drawn anew.

import type { Graph, GraphChanges, PartChanges } from "../protocol";

/** The picture that differs so from one. */
export function changed(graph: Graph, { nodes, groups, edges, rest }: GraphChanges): Graph {
  return {
    ...rest,
    nodes: changedParts(graph.nodes, nodes),
    groups: changedParts(graph.groups, groups),
    edges: changedParts(graph.edges, edges),
  };
}

function changedParts<T extends { id: string }>(parts: T[], changes: PartChanges<T>): T[] {
  if (!changes.put.length && !changes.gone.length && !changes.order) return parts;
  const known = new Map(parts.map((each) => [each.id, each]));
  for (const id of changes.gone) known.delete(id);
  for (const each of changes.put) known.set(each.id, each);
  return changes.order?.flatMap((id) => known.get(id) ?? []) ?? [...known.values()];
}
