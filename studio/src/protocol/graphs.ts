// Graphs: what a diagram shows.

import type { Freshness, LayoutKey, Point, Ref } from "./project";

export type Severity = "error" | "warning" | "info";

export interface Finding {
  severity: Severity;
  message: string;
}

export interface GraphPort {
  id: string;
  element: Ref | "";
  key: LayoutKey;
  label: string;
  note: string;
  mark: string;
  depth: number;
  /** From the top of the box. */
  y: number;
  height: number;
  details: [string, string][];
  findings: Finding[];
}

export interface GraphNode {
  id: string;
  element: Ref | "";
  key: LayoutKey;
  kind: string;
  title: string;
  subtitle: string[];
  group: string;
  column: number;
  details: [string, string][];
  findings: Finding[];
  x: number;
  y: number;
  width: number;
  height: number;
  /** Height of what stands above the rows. */
  head: number;
  /** Whether it is the state that its frame is entered in. */
  initial: boolean;
  ports: GraphPort[];
}

export interface GraphGroup {
  id: string;
  element: Ref | "";
  key: LayoutKey;
  kind: string;
  title: string;
  parent: string;
  x: number;
  y: number;
  width: number;
  height: number;
}

export interface GraphEnd {
  node: string;
  port: string;
}

export interface GraphEdge {
  id: string;
  element: Ref | "";
  key: LayoutKey;
  source: GraphEnd;
  target: GraphEnd;
  kind: string;
  title: string;
  labels: string[];
  count: number;
  findings: Finding[];
  /** A start, then three points for each cubic Bezier curve; empty for none. */
  route: Point[];
  /** Where its label is anchored, and half of its height. */
  label: Point | null;
  anchor: "start" | "middle" | "end";
}

export interface Graph {
  view: string;
  title: string;
  /** What it shows; empty for the whole model. */
  element: Ref | "";
  downwards: boolean;
  /** Lines have no room for labels. */
  crowded: boolean;
  /** Its frames are closed unless they are asked for. */
  folded?: boolean;
  width: number;
  height: number;
  nodes: GraphNode[];
  groups: GraphGroup[];
  edges: GraphEdge[];
}

/** What has changed in a list of parts: those that are put take the place of those of their id. */
export interface PartChanges<T> {
  put: T[];
  gone: string[];
  /** The ids in their order, where parts that are new do not come last. */
  order: string[] | null;
}

/** What makes a picture of the one before it. */
export interface GraphChanges {
  /** Number of the picture before it. */
  base: number;
  nodes: PartChanges<GraphNode>;
  groups: PartChanges<GraphGroup>;
  edges: PartChanges<GraphEdge>;
  /** All that is no list of parts. */
  rest: Omit<Graph, "nodes" | "groups" | "edges">;
}

/** A picture, or what has changed since the one that the page has. */
export interface ViewResult {
  revision: number;
  freshness?: Freshness;
  /** Whether its findings are those of its revision. */
  checked?: boolean;
  picture?: number;
  graph?: Graph;
  changes?: GraphChanges;
}
