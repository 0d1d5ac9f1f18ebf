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
  for (const each of graph.groups) if (inside.has(each.parent)) inside.add(each.id);
  return {
    boxes: graph.nodes.filter((each) => inside.has(each.group)),
    frames: graph.groups.filter((each) => inside.has(each.id)),
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
  const group = graph.groups.find((each) => frameId(each.id) === frame);
  if (!group) return after;
  const from = before.get(frame) ?? group;
  const [dx, dy] = [to.x - from.x, to.y - from.y];
  const { boxes, frames } = contentOf(graph, group.id);
  const parts: (readonly [string, XYPosition])[] = [
    ...boxes.map((each) => [each.id, each] as const),
    ...frames.map((each) => [frameId(each.id), each] as const),
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
    const group = graph.groups.find((each) => each.id === id);
    if (!group || group.kind === "host") return group?.id ?? "";
    id = group.parent;
  }
  return "";
}

/** The hosts: the frames of those where something runs, and the boxes of the others. */
export function hostsOf(graph: Graph): (GraphGroup | GraphNode)[] {
  return [...graph.groups, ...graph.nodes].filter((each) => each.kind === "host");
}

/** The host that has a point in its frame or box, empty for none. */
export function hostAt(graph: Graph, { x, y }: XYPosition): string {
  const found = hostsOf(graph).filter(
    (each) => each.x <= x && x <= each.x + each.width && each.y <= y && y <= each.y + each.height,
  );
  return found.at(-1)?.id ?? "";
}

/** Ids of the boxes that are meant by parts: of rows their box, of frames all in them. */
export function boxesOf(graph: Graph, keys: PartKey[]): string[] {
  const found = keys.flatMap((key) => {
    const part = partOf(key);
    if (part.of === "port") return [part.node];
    if (part.of === "node") return [part.id];
    return part.of === "group" ? contentOf(graph, part.id).boxes.map((each) => each.id) : [];
  });
  return [...new Set(found)];
}

/** Id of the frame that a part stands in, empty for none. */
export function frameAround(graph: Graph, key: PartKey): string {
  const part = partOf(key);
  if (part.of === "group") return graph.groups.find((each) => each.id === part.id)?.parent ?? "";
  if (part.of === "edge") return "";
  const node = indexOf(graph).nodes.get(part.of === "port" ? part.node : part.id);
  return node?.group ?? "";
}
