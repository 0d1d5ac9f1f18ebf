import { expect, test } from "vitest";
import { changed } from "../actions";
import type { Graph, GraphGroup } from "../protocol";
import { carriedOver, groupKey, nodeKey } from "../selection";
import { node, smallGraph } from "../testing/graphs";
import { openedIn } from "./levels";

const frames = (count: string): [string, string][] => [["frames", count]];
const host = node("host", [], {
  kind: "closed",
  width: 8000,
  height: 4000,
  head: 4000,
  details: frames("9"),
});
const bridge = node("bridge", [], {
  kind: "closed",
  x: 9000,
  width: 800,
  height: 400,
  details: frames("0"),
});
const graph: Graph = { ...smallGraph(), folded: true, nodes: [host, bridge], edges: [] };
const group: GraphGroup = { ...host, kind: "host", title: "host", parent: "" };
const at = (zoom: number, x = 0) => ({ x, y: 0, zoom, width: 1000, height: 600 });

test("a frame of frames is opened when these can be told apart, one of boxes when they can be read", () => {
  expect(openedIn(graph, at(0.03), null)).toEqual([]);
  expect(openedIn(graph, at(0.07), null)).toEqual(["key:host"]);
  expect(openedIn(graph, at(0.35, -3000), null)).toEqual(["key:bridge"]);
});

test("what is open stays so a while, and longer where the keyboard stands", () => {
  const inner = { ...bridge, group: "host" };
  const open: Graph = { ...graph, groups: [group], nodes: [inner] };
  expect(openedIn(open, at(0.05), null)).toEqual(["key:host"]);
  expect(openedIn(open, at(0.02), null)).toEqual([]);
  expect(openedIn(open, at(0.07, 5000), null)).toEqual([]);
  expect(openedIn(open, at(0.07, 5000), nodeKey("bridge"))).toEqual(["key:host"]);
});

test("a frame that is opened or closed stays chosen", () => {
  const open: Graph = { ...graph, groups: [group], nodes: [bridge] };
  expect(carriedOver([nodeKey("host")], graph, open)).toEqual([groupKey("host")]);
  expect(carriedOver([groupKey("host")], open, graph)).toEqual([nodeKey("host")]);
});

test("a difference keeps what has not changed as it is", () => {
  const { nodes, groups, edges, ...rest } = smallGraph();
  const before = { ...rest, nodes, groups, edges };
  const nothing = { put: [], gone: [], order: null };
  const after = changed(before, {
    base: 1,
    nodes: {
      put: [node("ocu", []), node("new", [])],
      gone: ["base"],
      order: ["new", "ocu", "bridge"],
    },
    groups: nothing,
    edges: { put: [], gone: ["e1"], order: null },
    rest: { ...rest, width: 7 },
  });
  expect(after.nodes.map((entry) => entry.id)).toEqual(["new", "ocu", "bridge"]);
  expect(after.nodes[2]).toBe(nodes[1]);
  expect(after.edges.map((edge) => edge.id)).toEqual(["e2", "e3", "e4"]);
  expect(after.groups).toBe(groups);
  expect(after.width).toBe(7);
});
