// Keys of the diagram: going about, and moving boxes.

import { useReactFlow, type XYPosition } from "@xyflow/react";
import { type KeyboardEvent, useCallback, useEffect, useRef } from "react";
import { place, select } from "../actions";
import { boxesOf } from "../canvas/frames";
import { type Direction, jump, step } from "../canvas/navigation";
import type { Graph, LayoutKey, Point } from "../protocol";
import { CLOSED, indexOf, nodeKey, type PartKey, partOf, portKey } from "../selection";
import { active, state } from "../store";
import { isTyping, nameOfKey } from "./keys";
import { PART_KEYS, press } from "./partKeys";

const DIRECTIONS: Record<string, Direction> = {
  ArrowLeft: "left",
  ArrowRight: "right",
  ArrowUp: "up",
  ArrowDown: "down",
};
const STEP = 10;
const FAR_STEP = 50;
/** Moves that follow each other so soon are one edit. */
const PAUSE_MS = 400;

type SetMoved = (
  change: (before: ReadonlyMap<string, XYPosition>) => ReadonlyMap<string, XYPosition>,
) => void;

/** The handler of keys of the diagram. */
export function useCanvasKeys(graph: Graph, setMoved: SetMoved) {
  const flow = useReactFlow();
  const before = useRef<PartKey | null>(null);
  const nudge = useNudge(graph, setMoved);
  return useCallback(
    (event: KeyboardEvent) => {
      if (isTyping(event.nativeEvent)) return;
      const name = nameOfKey(event);
      const direction = DIRECTIONS[event.key];
      if (direction) {
        event.preventDefault();
        if (event.altKey) nudge(direction, event.shiftKey ? FAR_STEP : STEP);
        else go(graph, direction, event, before);
        return;
      }
      const zooming = { "+": () => flow.zoomIn(), "-": () => flow.zoomOut() }[name];
      const doing = zooming ?? ENDS_OF_ROWS[name] ?? PART_KEYS[name];
      if (!doing) return;
      event.preventDefault();
      press(doing);
    },
    [graph, flow, nudge],
  );
}

function go(
  graph: Graph,
  direction: Direction,
  event: { ctrlKey: boolean; metaKey: boolean; shiftKey: boolean },
  before: { current: PartKey | null },
): void {
  const from = active(state());
  const isJump = event.ctrlKey || event.metaKey;
  const to = isJump ? jump(graph, from, direction) : step(graph, from, direction, before.current);
  if (!to || to === from) return;
  if (from && partOf(from).of !== "edge") before.current = from;
  const { selection } = state();
  select(event.shiftKey ? [...selection.filter((key) => key !== to), to] : [to]);
}

const ENDS_OF_ROWS: Record<string, () => void> = {
  Home: () => toRow(0),
  End: () => toRow(-1),
};

function toRow(at: number): void {
  const { graph } = state();
  const key = active(state());
  const part = key ? partOf(key) : null;
  const id = part?.of === "port" ? part.node : part?.of === "node" ? part.id : "";
  const node = graph && indexOf(graph).nodes.get(id);
  const port = node?.ports.at(at);
  if (node) select([port ? portKey(node.id, port.id) : nodeKey(node.id)]);
}

/** Moves the selected boxes; what is moved in a row is one edit. */
function useNudge(graph: Graph, setMoved: SetMoved) {
  const waiting = useRef(new Map<string, XYPosition>());
  // Another view may be shown before they are told.
  const shown = useRef(state());
  const timer = useRef<ReturnType<typeof setTimeout>>(undefined);
  const keep = useCallback(() => {
    clearTimeout(timer.current);
    const positions: Record<LayoutKey, Point> = {};
    for (const [id, { x, y }] of waiting.current) {
      const node = indexOf(graph).nodes.get(id);
      if (node) positions[node.key] = [x, y];
    }
    waiting.current = new Map();
    if (Object.keys(positions).length) {
      void place(positions, shown.current).then((result) => {
        if (!result) setMoved(() => new Map());
      });
    }
  }, [graph, setMoved]);
  useEffect(() => keep, [keep]);
  return useCallback(
    (direction: Direction, far: number) => {
      const [dx, dy] = { left: [-far, 0], right: [far, 0], up: [0, -far], down: [0, far] }[
        direction
      ] as Point;
      if (waiting.current.size === 0) shown.current = state();
      for (const id of boxesOf(graph, state().selection)) {
        const node = indexOf(graph).nodes.get(id);
        const at = waiting.current.get(id) ?? node;
        if (at && node?.kind !== CLOSED)
          waiting.current.set(id, { x: Math.round(at.x + dx), y: Math.round(at.y + dy) });
      }
      setMoved((before) => new Map([...before, ...waiting.current]));
      clearTimeout(timer.current);
      timer.current = setTimeout(keep, PAUSE_MS);
    },
    [graph, setMoved, keep],
  );
}
