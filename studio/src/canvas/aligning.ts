// Boxes in line with each other, or as far from each other.

import type { GraphNode, LayoutKey, Point } from "../protocol";

export const ALIGNMENTS = {
  left: "left edges",
  centre: "centres",
  right: "right edges",
  top: "upper edges",
  middle: "middles",
  bottom: "lower edges",
  across: "spread from left to right",
  down: "spread from top to bottom",
} as const;

export type Alignment = keyof typeof ALIGNMENTS;

/** Places of the boxes that have to move. */
export function aligned(boxes: readonly GraphNode[], way: Alignment): Record<LayoutKey, Point> {
  const places = way === "across" || way === "down" ? spread(boxes, way) : inLine(boxes, way);
  const moved = boxes.flatMap((box): [LayoutKey, Point][] => {
    const [x, y] = places.get(box.key) ?? [box.x, box.y];
    return x === box.x && y === box.y ? [] : [[box.key, [x, y]]];
  });
  return Object.fromEntries(moved);
}

type Line = Exclude<Alignment, "across" | "down">;

function inLine(boxes: readonly GraphNode[], way: Line): Map<LayoutKey, Point> {
  const left = Math.min(...boxes.map((each) => each.x));
  const right = Math.max(...boxes.map((each) => each.x + each.width));
  const top = Math.min(...boxes.map((each) => each.y));
  const bottom = Math.max(...boxes.map((each) => each.y + each.height));
  const place: Record<Line, (box: GraphNode) => Point> = {
    left: ({ y }) => [left, y],
    centre: ({ y, width }) => [Math.round((left + right - width) / 2), y],
    right: ({ y, width }) => [right - width, y],
    top: ({ x }) => [x, top],
    middle: ({ x, height }) => [x, Math.round((top + bottom - height) / 2)],
    bottom: ({ x, height }) => [x, bottom - height],
  };
  return new Map(boxes.map((each) => [each.key, place[way](each)]));
}

/** The outermost stay, and the gaps between all become the same. */
function spread(boxes: readonly GraphNode[], way: "across" | "down"): Map<LayoutKey, Point> {
  const start = (box: GraphNode) => (way === "across" ? box.x : box.y);
  const size = (box: GraphNode) => (way === "across" ? box.width : box.height);
  const inOrder = [...boxes].sort((a, b) => start(a) - start(b));
  const [first, last] = [inOrder[0], inOrder.at(-1)];
  if (!first || !last || first === last) return new Map();
  const room = start(last) + size(last) - start(first);
  const gap = (room - inOrder.reduce((sum, each) => sum + size(each), 0)) / (inOrder.length - 1);
  let at = start(first);
  return new Map(
    inOrder.map((each) => {
      const to = Math.round(at);
      at += size(each) + gap;
      return [each.key, way === "across" ? [to, each.y] : [each.x, to]];
    }),
  );
}
