// Which frames of a large system are shown with what is in them: those that are seen, and near enough.

import { useStore } from "@xyflow/react";
import { useEffect } from "react";
import { openFrames } from "../actions";
import type { Graph, GraphGroup, GraphNode, LayoutKey } from "../protocol";
import { CLOSED, indexOf, type PartKey, partOf } from "../selection";
import { active, state, useStudio } from "../store";

/** Zoom from which boxes can be read. */
const NEAR = 0.3;
/** Pixels of a frame from which the frames in it can be told apart. */
const WIDE = 320;
const TALL = 260;
/** What is open stays so until it is that much smaller, and that many windows away. */
const LESS = 0.75;
const BEYOND = 0.5;
const PAUSE_MS = 60;

/** A window onto the diagram: how far its corner is moved, and how large all is. */
export interface Sight {
  x: number;
  y: number;
  zoom: number;
  width: number;
  height: number;
}

/** Keys of the frames that are to be open. */
export function openedIn(graph: Graph, sight: Sight, here: PartKey | null): LayoutKey[] {
  const kept = around(graph, here);
  const holders = new Set([...graph.groups.map((group) => group.parent), ...closedIn(graph)]);
  const groups = graph.groups.filter(
    (group) =>
      kept.has(group.id) ||
      isNear(group, sight, holders.has(group.id), { scale: LESS, far: BEYOND }),
  );
  const closed = graph.nodes.filter(
    (node) => node.kind === CLOSED && isNear(node, sight, holdsFrames(node), { scale: 1, far: 0 }),
  );
  return [...groups, ...closed].map((group) => group.key).sort();
}

const closedIn = (graph: Graph) =>
  graph.nodes.filter((node) => node.kind === CLOSED).map((node) => node.group);

const holdsFrames = (node: GraphNode) =>
  node.details.some(([name, text]) => name === "frames" && text !== "0");

function isNear(
  { x, y, width, height }: GraphGroup | GraphNode,
  sight: Sight,
  hasFrames: boolean,
  { scale, far }: { scale: number; far: number },
): boolean {
  const { zoom } = sight;
  const [left, top] = [x * zoom + sight.x, y * zoom + sight.y];
  const [right, bottom] = [left + width * zoom, top + height * zoom];
  const [beside, beyond] = [sight.width * far, sight.height * far];
  const isSeen =
    right > -beside &&
    left < sight.width + beside &&
    bottom > -beyond &&
    top < sight.height + beyond;
  if (!isSeen) return false;
  if (!hasFrames) return zoom >= NEAR * scale;
  return width * zoom >= WIDE * scale || height * zoom >= TALL * scale;
}

/** The frames around a part. */
function around(graph: Graph, key: PartKey | null): Set<string> {
  const part = key ? partOf(key) : null;
  const { nodes, edges } = indexOf(graph);
  const groups = new Map(graph.groups.map((group) => [group.id, group]));
  const starts =
    part?.of === "edge"
      ? [edges.get(part.id)?.source.node, edges.get(part.id)?.target.node]
      : [part?.of === "port" ? part.node : part?.id];
  const levels = new Set<string>();
  for (const start of starts) {
    let name = nodes.get(start ?? "")?.group ?? groups.get(start ?? "")?.parent ?? "";
    for (; groups.has(name); name = groups.get(name)?.parent ?? "") levels.add(name);
  }
  return levels;
}

/** Opens what one looks at, and closes what one has left. */
export function useLevels(graph: Graph): void {
  const here = useStudio(active);
  const wanted = useStore(({ transform: [x, y, zoom], width, height }) =>
    graph.folded && width
      ? JSON.stringify(openedIn(graph, { x, y, zoom, width, height }, here))
      : null,
  );
  useEffect(() => {
    if (wanted === null || wanted === JSON.stringify(state().opened)) return;
    const timer = setTimeout(() => openFrames(JSON.parse(wanted) as LayoutKey[]), PAUSE_MS);
    return () => clearTimeout(timer);
  }, [wanted]);
}
