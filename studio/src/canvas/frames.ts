// What stands in frames, and which host's frame a box is in.

import type { XYPosition } from "@xyflow/react";
import type { Graph, GraphGroup, GraphNode } from "../protocol";
import { indexOf, type PartKey, partOf } from "../selection";
import { frameId, type Moved } from "./flow";

/** A frame, and the frames and boxes in it, however deep. */
export function contentOf(
  graph: Graph,
  group: string,
): { boxes: GraphNode[]; frames: GraphGroup[] } {
  const inside = new Set([group]);
  // Outer frames come before those in them.
  for (const other of graph.groups) if (inside.has(other.parent)) inside.add(other.id);
  return {
    boxes: graph.nodes.filter((node) => inside.has(node.group)),
    frames: graph.groups.filter((other) => inside.has(other.id)),
  };
}

/** Places of a frame that is moved, and of all that stands in it. */
export function movedTogether(
  graph: Graph,
  before: Moved,
  frame: string,
  to: XYPosition,
): Map<string, XYPosition> {
  const after = new Map(before);
  const group = graph.groups.find((candidate) => frameId(candidate.id) === frame);
  if (!group) return after;
  const from = before.get(frame) ?? group;
  const [dx, dy] = [to.x - from.x, to.y - from.y];
  const { boxes, frames } = contentOf(graph, group.id);
  const parts: (readonly [string, XYPosition])[] = [
    ...boxes.map((box) => [box.id, box] as const),
    ...frames.map((entry) => [frameId(entry.id), entry] as const),
  ];
  for (const [id, { x, y }] of parts) {
    const at = before.get(id) ?? { x, y };
    after.set(id, { x: at.x + dx, y: at.y + dy });
  }
  return after;
}

/** The host in whose frame a box stands, empty for none. */
export function hostOf(graph: Graph, node: GraphNode): string {
  for (let id = node.group; id; ) {
    const group = graph.groups.find((candidate) => candidate.id === id);
    if (!group || group.kind === "host") return group?.id ?? "";
    id = group.parent;
  }
  return "";
}

/** The hosts: the frames of those where something runs, and the boxes of the others. */
export function hostsOf(graph: Graph): (GraphGroup | GraphNode)[] {
  return [...graph.groups, ...graph.nodes].filter((part) => part.kind === "host");
}

/** The host that has a point in its frame or box, empty for none. */
export function hostAt(graph: Graph, { x, y }: XYPosition): string {
  const hosts = hostsOf(graph).filter(
    (host) => host.x <= x && x <= host.x + host.width && host.y <= y && y <= host.y + host.height,
  );
  return hosts.at(-1)?.id ?? "";
}

/** Ids of the boxes that are meant by parts: of rows their box, of frames all in them. */
export function boxesOf(graph: Graph, keys: PartKey[]): string[] {
  const boxes = keys.flatMap((key) => {
    const part = partOf(key);
    if (part.of === "port") return [part.node];
    if (part.of === "node") return [part.id];
    return part.of === "group" ? contentOf(graph, part.id).boxes.map((box) => box.id) : [];
  });
  return [...new Set(boxes)];
}

/** Id of the frame that a part stands in, empty for none. */
export function frameAround(graph: Graph, key: PartKey): string {
  const part = partOf(key);
  if (part.of === "group") return graph.groups.find((group) => group.id === part.id)?.parent ?? "";
  if (part.of === "edge") return "";
  const node = indexOf(graph).nodes.get(part.of === "port" ? part.node : part.id);
  return node?.group ?? "";
}
