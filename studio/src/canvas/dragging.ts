// Dragging: boxes, frames with all in them, and items of the palette.

import { type NodeChange, useReactFlow, type XYPosition } from "@xyflow/react";
import { type DragEvent, useCallback } from "react";
import { CARRIED, carry, DRAGGED, drop, place, placeOn } from "../actions";
import type { Graph, LayoutKey, PaletteItem, Point } from "../protocol";
import { elementOf, groupKey, indexOf, nodeKey, type PartKey, partOf } from "../selection";
import { state, update } from "../store";
import { type FlowNode, frameId, type Moved, NOTHING_MOVED } from "./flow";
import { contentOf, hostAt, hostOf, movedTogether } from "./frames";

type SetMoved = (change: (before: Moved) => Moved) => void;

/** What React Flow tells of dragging; `setMoved` shows it until the server has it. */
export function useDragging(graph: Graph, setMoved: SetMoved) {
  const flow = useReactFlow();
  const onMoved = useCallback(
    (changes: NodeChange<FlowNode>[]) => {
      const places = changes.flatMap((change) =>
        change.type === "position" && change.position
          ? [[change.id, change.position] as const]
          : [],
      );
      if (!places.length) return;
      const frames = new Set(graph.groups.map((group) => frameId(group.id)));
      setMoved((before) => {
        let after = new Map(before);
        for (const [id, to] of places) {
          if (frames.has(id)) after = movedTogether(graph, after, id, to);
          else after.set(id, to);
        }
        return after;
      });
    },
    [graph, setMoved],
  );

  const onDrag = useCallback(
    (event: Dragging, dragged: FlowNode[]) => {
      const host = hostUnder(graph, dragged, flow.screenToFlowPosition(pointOf(event)));
      mark(host ? partOfHost(graph, host.id) : null);
    },
    [graph, flow],
  );

  const onDragStop = useCallback(
    async (event: Dragging, dragged: FlowNode[]) => {
      mark(null);
      const positions = placesOf(graph, dragged);
      if (!Object.keys(positions).length) return setMoved(() => NOTHING_MOVED);
      const host = hostUnder(graph, dragged, flow.screenToFlowPosition(pointOf(event)));
      const done = host ? await placeOn(host.id, host.boxes, positions) : await place(positions);
      if (!done) setMoved(() => NOTHING_MOVED);
    },
    [graph, flow, setMoved],
  );

  return { onMoved, onDrag, onDragStop };
}

/** Where boxes stand after they, or frames around them, were dragged; by key. */
function placesOf(graph: Graph, dragged: FlowNode[]): Record<LayoutKey, Point> {
  const positions: Record<LayoutKey, Point> = {};
  for (const flowNode of dragged) {
    const { x: toX, y: toY } = flowNode.position;
    const from = flowNode.type === "frame" ? flowNode.data.group : flowNode.data.node;
    const boxes =
      flowNode.type === "frame"
        ? contentOf(graph, flowNode.data.group.id).boxes
        : [flowNode.data.node];
    for (const { key, x, y } of boxes) {
      const to: Point = [Math.round(x + toX - from.x), Math.round(y + toY - from.y)];
      if (to[0] !== x || to[1] !== y) positions[key] = to;
    }
  }
  return positions;
}

/** The host whose frame is under the pointer, and the dragged boxes that do not run there. */
function hostUnder(
  graph: Graph,
  dragged: FlowNode[],
  pointer: XYPosition,
): { id: string; boxes: string[] } | null {
  if (dragged.some((node) => node.type === "frame")) return null;
  const id = hostAt(graph, pointer);
  const boxes = dragged.flatMap((node) =>
    node.type === "box" &&
    node.data.node.element &&
    node.data.node.kind !== "host" &&
    hostOf(graph, node.data.node) !== id
      ? [node.id]
      : [],
  );
  return boxes.length ? { id, boxes } : null;
}

/** What drags: a pointer, or a finger. */
type Dragging = { clientX: number; clientY: number } | { changedTouches: TouchList };

function pointOf(event: Dragging): XYPosition {
  const { clientX: x, clientY: y } =
    "clientX" in event ? event : (event.changedTouches[0] ?? { clientX: 0, clientY: 0 });
  return { x, y };
}

/** The frame of a host, or its box. */
function partOfHost(graph: Graph, id: string): PartKey {
  return graph.groups.some((group) => group.id === id) ? groupKey(id) : nodeKey(id);
}

function mark(under: PartKey | null): void {
  if (state().under !== under) update({ under });
}

/** Taking items of the palette, and rows of bridges, which go on the box under the pointer. */
export function useDropping(graph: Graph) {
  const flow = useReactFlow();
  function onDragOver(event: DragEvent) {
    const { types } = event.dataTransfer;
    const isCarried = types.includes(CARRIED);
    const under = boxUnder(event);
    if (!types.includes(DRAGGED) && !(isCarried && isBridge(under))) return mark(null);
    event.preventDefault();
    event.dataTransfer.dropEffect = isCarried ? "move" : "copy";
    mark(under);
  }
  async function onDrop(event: DragEvent) {
    const text = event.dataTransfer.getData(DRAGGED);
    const carried = event.dataTransfer.getData(CARRIED);
    const under = boxUnder(event);
    mark(null);
    if (!text && !carried) return;
    event.preventDefault();
    if (carried && under) return carry(JSON.parse(carried) as string[], idOf(under));
    const at = flow.screenToFlowPosition({ x: event.clientX, y: event.clientY });
    const onto = under ? elementOf(graph, under) : "";
    event.currentTarget.closest<HTMLElement>(".flow")?.focus(); // keys are for what is new
    await drop(JSON.parse(text) as PaletteItem, [at.x, at.y], onto);
  }
  const isBridge = (key: PartKey | null) =>
    key !== null && indexOf(graph).nodes.get(idOf(key))?.kind === "bridge";
  return { onDragOver, onDrop, onDragLeave: () => mark(null) };
}

function idOf(key: PartKey): string {
  const part = partOf(key);
  return part.of === "node" ? part.id : "";
}

function boxUnder(event: DragEvent): PartKey | null {
  const target = event.target instanceof Element ? event.target : null;
  const key = target?.closest<HTMLElement>("[data-part]")?.dataset.part;
  const part = key ? partOf(key) : null;
  if (part?.of === "port") return nodeKey(part.node);
  return part?.of === "node" ? nodeKey(part.id) : null;
}
