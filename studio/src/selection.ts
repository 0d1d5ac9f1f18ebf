// Parts of a graph under one kind of key each, which selection, keyboard and table share.

import type { Graph, GraphEdge, GraphNode, GraphPort, Ref } from "./protocol";

/** Kind of the box that stands for a closed frame. */
export const CLOSED = "closed";

/** Key of a node, a port, an edge or a frame of the shown graph. */
export type PartKey = string;

export type Part =
  | { of: "node"; id: string }
  | { of: "port"; node: string; id: string }
  | { of: "edge"; id: string }
  | { of: "group"; id: string };

// Ids hold no control characters that a reader let through unseen, so this cannot be part of one.
const BETWEEN = "\u001f";

export const nodeKey = (id: string): PartKey => `node${BETWEEN}${id}`;
export const portKey = (node: string, id: string): PartKey =>
  `port${BETWEEN}${node}${BETWEEN}${id}`;
export const edgeKey = (id: string): PartKey => `edge${BETWEEN}${id}`;
export const groupKey = (id: string): PartKey => `group${BETWEEN}${id}`;

export function partOf(key: PartKey): Part {
  const [of, first = "", second = ""] = key.split(BETWEEN);
  if (of === "port") return { of, node: first, id: second };
  return { of: of as "node" | "edge" | "group", id: first };
}

/** The parts of one graph by id, made once for each graph. */
interface Index {
  nodes: Map<string, GraphNode>;
  edges: Map<string, GraphEdge>;
  /** Edges that end at a box or one of its rows, by id of the box. */
  edgesOf: Map<string, GraphEdge[]>;
  byElement: Map<Ref, PartKey>;
  elements: Map<PartKey, Ref>;
}

const indexes = new WeakMap<Graph, Index>();

export function indexOf(graph: Graph): Index {
  const known = indexes.get(graph);
  if (known) return known;
  const index = makeIndex(graph);
  indexes.set(graph, index);
  return index;
}

function makeIndex(graph: Graph): Index {
  const index: Index = {
    nodes: new Map(graph.nodes.map((node) => [node.id, node])),
    edges: new Map(graph.edges.map((edge) => [edge.id, edge])),
    edgesOf: new Map(graph.nodes.map((node) => [node.id, []])),
    byElement: new Map(),
    elements: new Map(),
  };
  const add = (key: PartKey, element: Ref) => {
    if (!element) return;
    index.elements.set(key, element);
    if (!index.byElement.has(element)) index.byElement.set(element, key);
  };
  for (const node of graph.nodes) {
    add(nodeKey(node.id), node.element);
    for (const port of node.ports) add(portKey(node.id, port.id), port.element);
  }
  for (const edge of graph.edges) {
    add(edgeKey(edge.id), edge.element);
    index.edgesOf.get(edge.source.node)?.push(edge);
    if (edge.target.node !== edge.source.node) index.edgesOf.get(edge.target.node)?.push(edge);
  }
  for (const group of graph.groups) add(groupKey(group.id), group.element);
  return index;
}

function portOf(graph: Graph, node: string, port: string): GraphPort | undefined {
  return indexOf(graph)
    .nodes.get(node)
    ?.ports.find((candidate) => candidate.id === port);
}

/** Whether the graph has this part. */
export function has(graph: Graph, key: PartKey): boolean {
  const part = partOf(key);
  if (part.of === "node") return indexOf(graph).nodes.has(part.id);
  if (part.of === "edge") return indexOf(graph).edges.has(part.id);
  if (part.of === "port") return portOf(graph, part.node, part.id) !== undefined;
  return graph.groups.some((group) => group.id === part.id);
}

/** The element that a part shows, empty for none. */
export function elementOf(graph: Graph, key: PartKey): Ref | "" {
  return indexOf(graph).elements.get(key) ?? "";
}

/** What a part is called. */
export function nameOf(graph: Graph, key: PartKey): string {
  const part = partOf(key);
  if (part.of === "node") return indexOf(graph).nodes.get(part.id)?.title ?? "";
  if (part.of === "port") return portOf(graph, part.node, part.id)?.label ?? "";
  if (part.of === "group") return graph.groups.find((group) => group.id === part.id)?.title ?? "";
  const edge = indexOf(graph).edges.get(part.id);
  return edge ? edge.title || edge.labels.join(", ") : "";
}

/**
 * Finds parts again in a newer graph, by keys that go by names: ids shift when an earlier sibling
 * goes.
 */
export function carriedOver(
  keys: PartKey[],
  before: Graph,
  after: Graph,
  isRenamed = false,
): PartKey[] {
  return keys.flatMap((key) => {
    const successor = carried(partOf(key), before, after);
    // Names change the keys by which parts are found again, places do not.
    const isLost = !successor || partOf(successor).of !== partOf(key).of;
    return isRenamed && isLost && has(after, key) ? key : (successor ?? []);
  });
}

function carried(part: Part, before: Graph, after: Graph): PartKey | null {
  if (part.of === "edge") {
    const edge = again(part.id, before.edges, after.edges);
    return edge && edgeKey(edge.id);
  }
  if (part.of === "group") {
    const group = again(part.id, before.groups, after.groups);
    if (group) return groupKey(group.id);
    const closed = again(part.id, before.groups, after.nodes);
    return closed && nodeKey(closed.id);
  }
  const box = part.of === "node" ? part.id : part.node;
  const node = again(box, before.nodes, after.nodes);
  if (!node && part.of === "node") {
    // The box of a closed frame becomes the frame.
    const opened = again(box, before.nodes, after.groups);
    if (opened) return groupKey(opened.id);
  }
  if (!node || part.of === "node") return node && nodeKey(node.id);
  const rows = indexOf(before).nodes.get(box)?.ports ?? [];
  const port = again(part.id, rows, node.ports);
  return port ? portKey(node.id, port.id) : nodeKey(node.id);
}

type Keyed = { id: string; key: string };

function again<T extends Keyed>(id: string, before: Keyed[], after: T[]): T | null {
  const key = before.find((entry) => entry.id === id)?.key;
  return after.find((entry) => entry.key === key) ?? null;
}
