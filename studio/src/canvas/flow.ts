// Graphs as React Flow takes them: boxes at the server's sizes and places, lines between rows.

import { type Edge, type Node, type NodeHandle, Position, type XYPosition } from "@xyflow/react";
import type { Graph, GraphEdge, GraphEnd, GraphGroup, GraphNode } from "../protocol";
import { CLOSED, edgeKey, groupKey, indexOf, nodeKey, type PartKey } from "../selection";

export type BoxNode = Node<{ node: GraphNode }, "box">;
export type FrameNode = Node<{ group: GraphGroup }, "frame">;
export type FlowNode = BoxNode | FrameNode;
export type FlowEdge = Edge<{ edge: GraphEdge; isRouted: boolean; isAcross: boolean }, "line">;

/** Places of boxes that are being moved, by id. */
export type Moved = ReadonlyMap<string, XYPosition>;
export const NOTHING_MOVED: Moved = new Map();

/** Width and height of the ends of lines, which a pointer can take. */
export const HANDLE = 12;

/**
 * The size of what holds a part, as React Flow knows its size: it measures whatever has one in the
 * page, with all its ends, which makes the browser lay out the page again for each part.
 */
const UNMEASURED = { width: 0, height: 0 };

const SIDES = { l: Position.Left, r: Position.Right, t: Position.Top, b: Position.Bottom };
type Side = keyof typeof SIDES;

export const handleId = (side: Side, port: string): string => `${side}:${port}`;
export const portOfHandle = (handle: string | null | undefined): string => handle?.slice(2) ?? "";

/** The boxes and frames of a graph, none of them moved or selected. */
export function toNodes(graph: Graph): FlowNode[] {
  return [...graph.groups.map(toFrame), ...graph.nodes.map(toNode)];
}

// What is the same in the next picture is not drawn anew.
const frames = new WeakMap<GraphGroup, FrameNode>();
const boxes = new WeakMap<GraphNode, BoxNode>();
const lines = new WeakMap<GraphEdge, FlowEdge>();

const toFrame = (group: GraphGroup): FrameNode => kept(frames, group, makeFrame);
const toNode = (node: GraphNode): BoxNode => kept(boxes, node, makeNode);

function kept<K extends WeakKey, V>(known: WeakMap<K, V>, key: K, make: (key: K) => V): V {
  const drawn = known.get(key) ?? make(key);
  known.set(key, drawn);
  return drawn;
}

function makeFrame(group: GraphGroup): FrameNode {
  return {
    id: frameId(group.id),
    type: "frame",
    position: { x: group.x, y: group.y },
    style: UNMEASURED,
    measured: { width: group.width, height: group.height },
    data: { group },
    // By its title: what is in a frame, and the ground under it, take the pointer for themselves.
    dragHandle: ".frame > .title",
    selectable: false,
    connectable: false,
    zIndex: -1,
  };
}

function makeNode(node: GraphNode): BoxNode {
  const isClosed = node.kind === CLOSED;
  return {
    id: node.id,
    type: "box",
    position: { x: node.x, y: node.y },
    style: UNMEASURED,
    measured: { width: node.width, height: node.height },
    handles: handlesOf(node),
    data: { node },
    draggable: !isClosed,
    connectable: !isClosed,
  };
}

/** The same with what is moved and selected; all others stay the same objects, and are not drawn anew. */
export function withStates(
  nodes: FlowNode[],
  moved: Moved,
  selected: ReadonlySet<PartKey>,
): FlowNode[] {
  return nodes.map((node) => {
    const position = moved.get(node.id);
    const isSelected = selected.has(keyOfNode(node));
    if (!position && !isSelected) return node;
    return { ...node, position: position ?? node.position, selected: isSelected };
  });
}

/** Id of a frame among the nodes of React Flow, where boxes have their own ids. */
export const frameId = (group: string): string => `frame ${group}`;

export function keyOfNode(node: FlowNode): PartKey {
  return node.type === "frame" ? groupKey(node.data.group.id) : nodeKey(node.id);
}

function handlesOf(node: GraphNode): NodeHandle[] {
  const middle = node.head / 2;
  const own: NodeHandle[] = [
    handle("l", "", 0, middle),
    handle("r", "", node.width, middle),
    handle("t", "", node.width / 2, 0),
    handle("b", "", node.width / 2, node.height),
  ];
  const rows = node.ports.flatMap((port) => {
    const y = port.y + port.height / 2;
    return [handle("l", port.id, 0, y), handle("r", port.id, node.width, y)];
  });
  return [...own, ...rows];
}

/** An end whose outer edge is at the border of the box, where lines shall end. */
function handle(side: Side, port: string, x: number, y: number): NodeHandle {
  const left = { l: x, r: x - HANDLE, t: x - HANDLE / 2, b: x - HANDLE / 2 }[side];
  const top = { l: y - HANDLE / 2, r: y - HANDLE / 2, t: y, b: y - HANDLE }[side];
  return {
    id: handleId(side, port),
    type: "source",
    position: SIDES[side],
    x: left,
    y: top,
    width: HANDLE,
    height: HANDLE,
  };
}

/** The lines of a graph, none of them selected; to be asked again only for lines whose ends move. */
export function toEdges(graph: Graph, moved: Moved = NOTHING_MOVED): FlowEdge[] {
  const { nodes } = indexOf(graph);
  return graph.edges.flatMap((edge) => {
    const source = nodes.get(edge.source.node);
    const target = nodes.get(edge.target.node);
    return source && target ? [known(toEdge(graph, edge, source, target, moved), edge)] : [];
  });
}

/** The line of the picture before, where all is as it was. */
function known(line: FlowEdge, edge: GraphEdge): FlowEdge {
  const before = lines.get(edge);
  const isSame =
    before?.sourceHandle === line.sourceHandle &&
    before?.targetHandle === line.targetHandle &&
    before?.data?.isRouted === line.data?.isRouted &&
    before?.data?.isAcross === line.data?.isAcross;
  if (before && isSame) return before;
  lines.set(edge, line);
  return line;
}

function toEdge(
  graph: Graph,
  edge: GraphEdge,
  source: GraphNode,
  target: GraphNode,
  moved: Moved,
): FlowEdge {
  const [from, to] = sides(source, target, edge, moved, graph.downwards);
  const isMoved = moved.has(source.id) || moved.has(target.id);
  return {
    id: edge.id,
    type: "line",
    source: source.id,
    target: target.id,
    sourceHandle: handleId(from, rowOf(source, edge.source)),
    targetHandle: handleId(to, rowOf(target, edge.target)),
    data: {
      edge,
      isRouted: edge.route.length > 3 && !isMoved,
      isAcross: source.group !== target.group,
    },
  };
}

/** The same with what is selected, and with ways of their own where an end is moved. */
export function edgesWithStates(
  graph: Graph,
  edges: FlowEdge[],
  moved: Moved,
  selected: ReadonlySet<PartKey>,
): FlowEdge[] {
  const { nodes } = indexOf(graph);
  return edges.map((line) => {
    const isMoved = moved.has(line.source) || moved.has(line.target);
    const selectedNow = selected.has(edgeKey(line.id));
    if (!isMoved && !selectedNow) return line;
    const [source, target] = [nodes.get(line.source), nodes.get(line.target)];
    const now =
      isMoved && line.data && source && target
        ? toEdge(graph, line.data.edge, source, target, moved)
        : line;
    return { ...now, selected: selectedNow };
  });
}

function rowOf(node: GraphNode, end: GraphEnd): string {
  return node.ports.some((port) => port.id === end.port) ? end.port : "";
}

/** Sides at which a line leaves and arrives, so that it need not go around its own boxes. */
function sides(
  source: GraphNode,
  target: GraphNode,
  edge: GraphEdge,
  moved: Moved,
  downwards: boolean,
): [Side, Side] {
  const from = moved.get(source.id) ?? source;
  const to = moved.get(target.id) ?? target;
  if (source === target) return ["r", "r"];
  if (downwards && !edge.source.port && !edge.target.port) {
    if (from.y + source.height <= to.y) return ["b", "t"];
    if (to.y + target.height <= from.y) return ["t", "b"];
  }
  if (from.x + source.width <= to.x) return ["r", "l"];
  if (to.x + target.width <= from.x) return ["l", "r"];
  // One above the other: both ends at the side where the other columns are not.
  return source.column === 0 && target.column === 0 ? ["l", "l"] : ["r", "r"];
}

/** A route of the layout as a path of SVG. */
export function pathOf(route: GraphEdge["route"]): string {
  const [start, ...rest] = route;
  if (!start) return "";
  let path = `M${start[0]},${start[1]}`;
  for (let at = 0; at + 2 < rest.length; at += 3) {
    const [a, b, c] = [rest[at]!, rest[at + 1]!, rest[at + 2]!];
    path += `C${a[0]},${a[1]} ${b[0]},${b[1]} ${c[0]},${c[1]}`;
  }
  return path;
}

/** The middle of a route, for a label that the layout gave no place. */
export function middleOf(route: GraphEdge["route"]): XYPosition | null {
  const point = route[Math.floor(route.length / 2)];
  return point ? { x: point[0], y: point[1] } : null;
}

/** How far a line bends outwards between boxes above each other: the server makes frames so wide. */
const [LEAST, STEEP, MOST] = [24, 0.15, 90];
/** Height of a line from a row to itself. */
const LOOP = 16;

/** A way from one side of a box to the same side of another, or of the same. */
export function bend(
  side: Position,
  from: XYPosition,
  to: XYPosition,
): [path: string, x: number, y: number] {
  const end = Math.abs(to.y - from.y) < LOOP / 2 ? from.y + LOOP : to.y;
  const far = Math.min(LEAST + STEEP * Math.abs(end - from.y), MOST);
  const out = side === Position.Left ? Math.min(from.x, to.x) - far : Math.max(from.x, to.x) + far;
  const path = `M${from.x},${from.y}C${out},${from.y} ${out},${end} ${to.x},${end}`;
  return [path, (from.x + to.x) / 8 + 0.75 * out, (from.y + end) / 2];
}
