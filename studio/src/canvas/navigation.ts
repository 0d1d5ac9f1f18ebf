// Where the arrow keys lead: rows up and down, lines left and right, boxes with Ctrl.

import type { XYPosition } from "@xyflow/react";
import type { Graph, GraphEdge, GraphEnd, GraphNode } from "../protocol";
import { edgeKey, groupKey, indexOf, nodeKey, type PartKey, partOf, portKey } from "../selection";

export type Direction = "left" | "right" | "up" | "down";

/** The part that an arrow leads to; the same part where there is none. */
export function step(
  graph: Graph,
  from: PartKey | null,
  direction: Direction,
  before: PartKey | null = null,
): PartKey | null {
  const first = topLeft(graph);
  if (!first) return null;
  if (!from) return nodeKey(first.id);
  const part = partOf(from);
  const index = indexOf(graph);
  if (part.of === "edge") {
    const edge = index.edges.get(part.id);
    return edge ? fromEdge(graph, edge, direction, before) : nodeKey(first.id);
  }
  if (part.of === "group") {
    const inside = graph.nodes.find((candidate) => candidate.group === part.id) ?? first;
    return nodeKey(inside.id);
  }
  const node = index.nodes.get(part.of === "port" ? part.node : part.id);
  if (!node) return nodeKey(first.id);
  const row = part.of === "port" ? node.ports.findIndex((port) => port.id === part.id) : -1;
  if (direction === "up" || direction === "down") return alongRows(graph, node, row, direction);
  return alongLines(graph, node, row, direction) ?? neighbour(graph, node, direction) ?? from;
}

/** The next box in a direction, whatever lines there are. */
export function jump(graph: Graph, from: PartKey | null, direction: Direction): PartKey | null {
  const first = topLeft(graph);
  if (!from) return first ? nodeKey(first.id) : null;
  const part = partOf(from);
  if (part.of === "edge") {
    const edge = indexOf(graph).edges.get(part.id);
    return edge ? nodeKey(edge.source.node) : from;
  }
  const node = indexOf(graph).nodes.get(part.of === "port" ? part.node : part.id);
  return (node && neighbour(graph, node, direction)) ?? from;
}

function alongRows(graph: Graph, node: GraphNode, row: number, direction: Direction): PartKey {
  const next = row + (direction === "down" ? 1 : -1);
  const port = node.ports[next];
  if (port) return portKey(node.id, port.id);
  if (row >= 0 && next < 0) return nodeKey(node.id);
  return neighbour(graph, node, direction) ?? here(node, row);
}

function here(node: GraphNode, row: number): PartKey {
  const port = node.ports[row];
  return port ? portKey(node.id, port.id) : nodeKey(node.id);
}

function alongLines(
  graph: Graph,
  node: GraphNode,
  row: number,
  direction: Direction,
): PartKey | null {
  const port = node.ports[row]?.id;
  const edges = (indexOf(graph).edgesOf.get(node.id) ?? []).filter((edge) => {
    const [own, other] = edge.source.node === node.id ? both(edge) : both(edge).reverse();
    if (port !== undefined && own?.port !== port) return false;
    return other !== undefined && isTowards(graph, node, other, direction);
  });
  const first = edges.sort((a, b) => height(graph, a) - height(graph, b))[0];
  return first ? edgeKey(first.id) : null;
}

const both = (edge: GraphEdge): GraphEnd[] => [edge.source, edge.target];

function isTowards(graph: Graph, node: GraphNode, end: GraphEnd, direction: Direction): boolean {
  const other = indexOf(graph).nodes.get(end.node);
  if (!other) return false;
  const isRight = middle(other).x >= middle(node).x;
  return isRight === (direction === "right");
}

function height(graph: Graph, edge: GraphEdge): number {
  return spot(graph, edge.source).y + spot(graph, edge.target).y;
}

function fromEdge(
  graph: Graph,
  edge: GraphEdge,
  direction: Direction,
  before: PartKey | null,
): PartKey {
  const [left, right] = both(edge).sort((a, b) => spot(graph, a).x - spot(graph, b).x) as [
    GraphEnd,
    GraphEnd,
  ];
  if (direction === "left") return keyOfEnd(graph, left);
  if (direction === "right") return keyOfEnd(graph, right);
  // Up and down: the other lines at this side of the box from which this line was reached.
  const around = before ? partOf(before) : null;
  const box =
    around?.of === "port" ? around.node : around?.of === "node" ? around.id : edge.source.node;
  const beside = (indexOf(graph).edgesOf.get(box) ?? [])
    .filter((other) => isRightOf(graph, other, box) === isRightOf(graph, edge, box))
    .sort((a, b) => height(graph, a) - height(graph, b));
  const at = beside.findIndex((candidate) => candidate.id === edge.id);
  const next = beside[at + (direction === "down" ? 1 : -1)];
  return edgeKey(next?.id ?? edge.id);
}

/** Whether a line of a box goes to its right. */
function isRightOf(graph: Graph, edge: GraphEdge, box: string): boolean {
  const node = indexOf(graph).nodes.get(box);
  const other = edge.source.node === box ? edge.target : edge.source;
  return node !== undefined && isTowards(graph, node, other, "right");
}

export function keyOfEnd(graph: Graph, end: GraphEnd): PartKey {
  const node = indexOf(graph).nodes.get(end.node);
  const port = node?.ports.find((candidate) => candidate.id === end.port);
  return port ? portKey(end.node, port.id) : nodeKey(end.node);
}

function spot(graph: Graph, end: GraphEnd): XYPosition {
  const node = indexOf(graph).nodes.get(end.node);
  if (!node) return { x: 0, y: 0 };
  const port = node.ports.find((candidate) => candidate.id === end.port);
  return { x: middle(node).x, y: node.y + (port ? port.y + port.height / 2 : node.head / 2) };
}

const middle = (node: GraphNode): XYPosition => ({
  x: node.x + node.width / 2,
  y: node.y + node.height / 2,
});

function topLeft(graph: Graph): GraphNode | undefined {
  return graph.nodes.reduce<GraphNode | undefined>(
    (best, node) => (!best || node.x + node.y < best.x + best.y ? node : best),
    undefined,
  );
}

/** The nearest box in a direction; what lies aside counts double. */
function neighbour(graph: Graph, node: GraphNode, direction: Direction): PartKey | null {
  const from = middle(node);
  const isAcross = direction === "left" || direction === "right";
  const sign = direction === "left" || direction === "up" ? -1 : 1;
  let best: GraphNode | null = null;
  let least = Number.POSITIVE_INFINITY;
  for (const other of graph.nodes) {
    const to = middle(other);
    const [ahead, aside] = isAcross
      ? [to.x - from.x, to.y - from.y]
      : [to.y - from.y, to.x - from.x];
    if (other === node || ahead * sign <= 0) continue;
    const distance = Math.abs(ahead) + 2 * Math.abs(aside);
    if (distance < least) [best, least] = [other, distance];
  }
  return best ? nodeKey(best.id) : null;
}

/** Where a part is drawn, for bringing it into sight. */
export function areaOf(
  graph: Graph,
  key: PartKey,
): { x: number; y: number; width: number; height: number } | null {
  const part = partOf(key);
  const index = indexOf(graph);
  if (part.of === "group") return graph.groups.find((group) => groupKey(group.id) === key) ?? null;
  if (part.of === "edge") {
    const edge = index.edges.get(part.id);
    if (!edge) return null;
    const [a, b] = [spot(graph, edge.source), spot(graph, edge.target)];
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, width: 1, height: 1 };
  }
  const node = index.nodes.get(part.of === "port" ? part.node : part.id);
  if (!node || part.of === "node") return node ?? null;
  const port = node.ports.find((candidate) => candidate.id === part.id);
  return port ? { x: node.x, y: node.y + port.y, width: node.width, height: port.height } : node;
}
