// Graphs for tests: the example in small, and of any size.

import type { Graph, GraphEdge, GraphNode, GraphPort } from "../protocol";

export function port(id: string, y: number, more: Partial<GraphPort> = {}): GraphPort {
  const rest = { note: "", mark: "", depth: 0, height: 18, details: [], findings: [] };
  const names = { element: `robot.xmi#${id}`, key: `key:${id}`, label: id };
  return { id, ...names, y, ...rest, ...more };
}

export function node(id: string, ports: string[], more: Partial<GraphNode> = {}): GraphNode {
  return {
    id,
    element: `robot.xmi#${id}`,
    key: `key:${id}`,
    kind: "component",
    title: id,
    subtitle: [],
    group: "",
    column: 0,
    details: [],
    findings: [],
    x: 0,
    y: 0,
    width: 120,
    height: 30 + 18 * ports.length,
    head: 30,
    initial: false,
    ports: ports.map((entry, at) => port(entry, 30 + 18 * at)),
    ...more,
  };
}

export function edge(
  id: string,
  source: [string, string],
  target: [string, string],
  more: Partial<GraphEdge> = {},
): GraphEdge {
  return {
    id,
    element: `robot.xmi#${id}`,
    key: `key:${id}`,
    source: { node: source[0], port: source[1] },
    target: { node: target[0], port: target[1] },
    kind: "message",
    title: id,
    labels: [],
    count: 1,
    findings: [],
    route: [],
    label: null,
    anchor: "middle",
    ...more,
  };
}

/** An operator's component, a bridge with two connections, and a node of ROS. */
export function smallGraph(): Graph {
  return {
    view: "system",
    title: "robot",
    element: "",
    downwards: false,
    crowded: false,
    width: 600,
    height: 200,
    groups: [],
    nodes: [
      node("ocu", ["drive", "pose"]),
      node("bridge", ["velocity", "odometry"], { kind: "bridge", x: 220, column: 1 }),
      node("base", ["/cmd_vel", "/odom"], { kind: "node", x: 440, column: 2 }),
    ],
    edges: [
      edge("e1", ["ocu", "drive"], ["bridge", "velocity"]),
      edge("e2", ["bridge", "velocity"], ["base", "/cmd_vel"], { kind: "topic" }),
      edge("e3", ["base", "/odom"], ["bridge", "odometry"], { kind: "topic" }),
      edge("e4", ["bridge", "odometry"], ["ocu", "pose"]),
    ],
  };
}

/** A graph of that many boxes in a grid, each with rows, and lines between them. */
export function bigGraph(boxes: number, rows: number, lines: number): Graph {
  const names = Array.from({ length: rows }, (_, at) => `row${at}`);
  const nodes = Array.from({ length: boxes }, (_, at) =>
    node(`box${at}`, names, { x: (at % 8) * 240, y: Math.floor(at / 8) * (80 + 18 * rows) }),
  );
  const edges = Array.from({ length: lines }, (_, at) =>
    edge(
      `line${at}`,
      [`box${at % boxes}`, `row${at % rows}`],
      [`box${(at * 7 + 1) % boxes}`, `row${(at * 3) % rows}`],
    ),
  );
  return { ...smallGraph(), nodes, edges };
}
