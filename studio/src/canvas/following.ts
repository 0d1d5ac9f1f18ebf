// What lies upstream and downstream of a part, and what a filter by name leaves bright.

import type { Graph, GraphEnd } from "../protocol";
import { edgeKey, indexOf, nodeKey, type PartKey, partOf, portKey } from "../selection";

export type Stream = "up" | "down" | "both";

/** All parts that what flows through a part comes through, or goes to. */
export function following(graph: Graph, from: PartKey, stream: Stream): Set<PartKey> {
  const reached = new Set<PartKey>([from]);
  if (stream !== "down") follow(graph, starts(graph, from, "up"), "up", reached);
  if (stream !== "up") follow(graph, starts(graph, from, "down"), "down", reached);
  return reached;
}

function starts(graph: Graph, from: PartKey, stream: "up" | "down"): GraphEnd[] {
  const part = partOf(from);
  const index = indexOf(graph);
  if (part.of === "port") return [{ node: part.node, port: part.id }];
  if (part.of === "edge") {
    const edge = index.edges.get(part.id);
    if (!edge) return [];
    // The line itself is passed already: its far end is where what follows begins.
    return [stream === "up" ? edge.source : edge.target];
  }
  const nodes =
    part.of === "group"
      ? graph.nodes.filter((node) => node.group === part.id)
      : [index.nodes.get(part.id)];
  return nodes.flatMap((node) =>
    node
      ? [
          { node: node.id, port: "" },
          ...node.ports.map((port) => ({ node: node.id, port: port.id })),
        ]
      : [],
  );
}

function follow(
  graph: Graph,
  ends: GraphEnd[],
  stream: "up" | "down",
  reached: Set<PartKey>,
): void {
  const index = indexOf(graph);
  const seen = new Set<string>();
  const waiting = [...ends];
  for (let end = waiting.pop(); end; end = waiting.pop()) {
    const key = portKey(end.node, end.port);
    if (seen.has(key)) continue;
    seen.add(key);
    reached.add(nodeKey(end.node));
    if (end.port) reached.add(key);
    for (const edge of index.edgesOf.get(end.node) ?? []) {
      const [near, far] =
        stream === "down" ? [edge.source, edge.target] : [edge.target, edge.source];
      if (near.node !== end.node || near.port !== end.port) continue;
      reached.add(edgeKey(edge.id));
      waiting.push(far);
    }
  }
}

/** Parts whose name holds a text, with the boxes of rows and the ends of lines; null for no text. */
export function matching(graph: Graph, text: string): Set<PartKey> | null {
  const sought = text.trim().toLowerCase();
  if (!sought) return null;
  const fits = (...names: string[]) => names.some((name) => name.toLowerCase().includes(sought));
  const reached = new Set<PartKey>();
  for (const node of graph.nodes) {
    const isNode = fits(node.title, ...node.subtitle);
    if (isNode) reached.add(nodeKey(node.id));
    for (const port of node.ports) {
      if (!isNode && !fits(port.label, port.note)) continue;
      reached.add(nodeKey(node.id)).add(portKey(node.id, port.id));
    }
  }
  for (const edge of graph.edges) {
    const isLine = fits(edge.title, ...edge.labels);
    const ends = [edge.source, edge.target];
    if (isLine) for (const end of ends) reached.add(nodeKey(end.node));
    if (isLine || ends.some((end) => end.port && reached.has(portKey(end.node, end.port)))) {
      reached.add(edgeKey(edge.id));
    }
  }
  return reached;
}

/** The parts that fit by their own name, in reading order, for going from one to the next. */
export function matches(graph: Graph, text: string): PartKey[] {
  const sought = text.trim().toLowerCase();
  if (!sought) return [];
  const boxes = [...graph.nodes].sort((a, b) => a.x - b.x || a.y - b.y);
  return boxes.flatMap((node) => [
    ...(node.title.toLowerCase().includes(sought) ? [nodeKey(node.id)] : []),
    ...node.ports
      .filter((port) => port.label.toLowerCase().includes(sought))
      .map((port) => portKey(node.id, port.id)),
  ]);
}
