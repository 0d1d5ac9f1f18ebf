import { Position } from "@xyflow/react";
import { expect, test } from "vitest";
import { edgeKey, nodeKey } from "../selection";
import { edge, smallGraph } from "../testing/graphs";
import {
  bend,
  edgesWithStates,
  HANDLE,
  pathOf,
  portOfHandle,
  toEdges,
  toNodes,
  withStates,
} from "./flow";

const NONE = new Map();

test("boxes have the sizes and places of the server, frames lie below them", () => {
  const graph = smallGraph();
  graph.groups = [
    {
      id: "h",
      element: "",
      key: "h",
      kind: "host",
      title: "onboard",
      parent: "",
      x: 1,
      y: 2,
      width: 3,
      height: 4,
    },
  ];
  const [frame, ocu, bridge] = withStates(toNodes(graph), NONE, new Set([nodeKey("bridge")]));
  expect(frame).toMatchObject({ type: "frame", position: { x: 1, y: 2 }, zIndex: -1 });
  expect(frame?.measured).toEqual({ width: 3, height: 4 });
  expect(ocu).toMatchObject({ id: "ocu", position: { x: 0, y: 0 } });
  expect(ocu?.measured).toEqual({ width: 120, height: 66 });
  expect(ocu?.selected).toBeFalsy();
  expect(bridge?.selected).toBe(true);
});

test("a row has an end at each border of its box, at its middle", () => {
  const [ocu] = toNodes(smallGraph());
  const ends = ocu?.handles?.filter((handle) => portOfHandle(handle.id) === "drive");
  expect(ends?.map(({ x, y }) => [x, y + HANDLE / 2])).toEqual([
    [0, 39],
    [120 - HANDLE, 39],
  ]);
});

test("a line leaves to the side where its other end stands, also while that is moved", () => {
  const graph = smallGraph();
  const handles = (moved: Map<string, { x: number; y: number }>) => {
    const line = edgesWithStates(graph, toEdges(graph), moved, new Set()).find(
      (candidate) => candidate.id === "e1",
    );
    return [line?.sourceHandle, line?.targetHandle];
  };
  expect(handles(NONE)).toEqual(["r:drive", "l:velocity"]);
  expect(handles(new Map([["bridge", { x: -300, y: 0 }]]))).toEqual(["l:drive", "r:velocity"]);
});

test("between boxes above each other a line bends outwards, farther the longer it is", () => {
  const graph = smallGraph();
  const [ocu, bridge] = graph.nodes;
  graph.edges = [edge("e", ["ocu", "drive"], ["bridge", "velocity"])];
  Object.assign(bridge!, { x: ocu!.x, y: 300, column: 0 });
  expect(toEdges(graph)[0]).toMatchObject({
    sourceHandle: "l:drive",
    targetHandle: "l:velocity",
  });
  Object.assign(ocu!, { column: 2 });
  expect(toEdges(graph)[0]?.sourceHandle).toBe("r:drive");
  expect(bend(Position.Left, { x: 10, y: 0 }, { x: 10, y: 100 })[0]).toBe(
    "M10,0C-29,0 -29,100 10,100",
  );
  expect(bend(Position.Right, { x: 10, y: 0 }, { x: 30, y: 1000 })[0]).toBe(
    "M10,0C120,0 120,1000 30,1000",
  );
  // From a row to itself it comes back a little below.
  expect(bend(Position.Right, { x: 10, y: 0 }, { x: 10, y: 0 })[0]).toMatch(/ 10,16$/);
});

test("the layout's route is drawn until an end moves", () => {
  const graph = smallGraph();
  graph.edges[0]!.route = [
    [0, 0],
    [1, 1],
    [2, 2],
    [3, 3],
  ];
  const isRouted = (moved: Map<string, { x: number; y: number }>) =>
    edgesWithStates(graph, toEdges(graph), moved, new Set())[0]?.data?.isRouted;
  expect(isRouted(NONE)).toBe(true);
  expect(isRouted(new Map([["base", { x: 1, y: 1 }]]))).toBe(true);
  expect(isRouted(new Map([["ocu", { x: 1, y: 1 }]]))).toBe(false);
});

test("what did not change is the same object, so that it is not drawn anew", () => {
  const graph = smallGraph();
  const [boxes, lines] = [toNodes(graph), toEdges(graph)];
  const moved = new Map([["ocu", { x: 9, y: 9 }]]);
  const nodes = withStates(boxes, moved, new Set([nodeKey("base")]));
  expect(nodes.map((node, at) => node === boxes[at])).toEqual([false, true, false]);
  const edges = edgesWithStates(graph, lines, moved, new Set([edgeKey("e2")]));
  expect(edges.map((entry, at) => entry === lines[at])).toEqual([false, false, true, false]);
  expect(edges[1]?.data).toBe(lines[1]?.data);
});

test("a line whose row is folded ends at the box, one without a box is not drawn", () => {
  const graph = smallGraph();
  graph.edges = [
    edge("a", ["ocu", "gone"], ["base", "/odom"]),
    edge("b", ["gone", ""], ["base", ""]),
  ];
  const lines = toEdges(graph);
  expect(lines.map((line) => [line.id, line.sourceHandle])).toEqual([["a", "r:"]]);
});

test("a route is a start and cubic curves", () => {
  expect(
    pathOf([
      [0, 1],
      [2, 3],
      [4, 5],
      [6, 7],
    ]),
  ).toBe("M0,1C2,3 4,5 6,7");
  expect(pathOf([])).toBe("");
});
