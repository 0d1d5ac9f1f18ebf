import { expect, test } from "vitest";
import type { GraphGroup } from "../protocol";
import { smallGraph } from "../testing/graphs";
import { frameId, NOTHING_MOVED } from "./flow";
import { contentOf, hostAt, hostOf, movedTogether } from "./frames";

function frame(id: string, kind: string, x: number, width: number, parent = ""): GraphGroup {
  return { id, element: id, key: id, kind, title: id, parent, x, y: 0, width, height: 300 };
}

/** The operator on the ground, the bridge in a frame of its own on the robot. */
function hosted() {
  const graph = smallGraph();
  graph.groups = [
    frame("ground", "host", -20, 180),
    frame("robot", "host", 200, 500),
    frame("bridge!frame", "bridge", 210, 150, "robot"),
  ];
  const [ocu, bridge, base] = graph.nodes;
  ocu!.group = "ground";
  bridge!.group = "bridge!frame";
  base!.group = "robot";
  return graph;
}

const ids = (all: { id: string }[]) => all.map((part) => part.id);

test("a frame holds boxes and frames, however deep", () => {
  const { boxes, frames } = contentOf(hosted(), "robot");
  expect(ids(boxes)).toEqual(["bridge", "base"]);
  expect(ids(frames)).toEqual(["robot", "bridge!frame"]);
});

test("all that stands in a frame moves with it, step by step", () => {
  const graph = hosted();
  const first = movedTogether(graph, NOTHING_MOVED, frameId("robot"), { x: 210, y: 5 });
  expect(first.get("bridge")).toEqual({ x: 230, y: 5 });
  const moved = movedTogether(graph, first, frameId("robot"), { x: 220, y: 0 });
  expect(moved.get("base")).toEqual({ x: 460, y: 0 });
  expect(moved.get(frameId("robot"))).toEqual({ x: 220, y: 0 });
  expect(moved.get(frameId("bridge!frame"))).toEqual({ x: 230, y: 0 });
  expect(moved.has("ocu")).toBe(false);
});

test("a box runs on the host whose frame is around it, also around the frame of its bridge", () => {
  const graph = hosted();
  expect(graph.nodes.map((node) => hostOf(graph, node))).toEqual(["ground", "robot", "robot"]);
  expect(hostAt(graph, { x: 0, y: 10 })).toBe("ground");
  expect(hostAt(graph, { x: 0, y: 900 })).toBe("");
});
