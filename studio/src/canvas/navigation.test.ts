import { expect, test } from "vitest";
import { edgeKey, nodeKey, portKey } from "../selection";
import { bigGraph, smallGraph } from "../testing/graphs";
import { following, matches, matching } from "./following";
import { type Direction, jump, step } from "./navigation";

const graph = smallGraph();

function walk(from: string | null, ...directions: Direction[]): string | null {
  let [here, before] = [from, from];
  for (const direction of directions) {
    const next = step(graph, here, direction, before);
    if (here?.startsWith("edge") === false) before = here;
    here = next;
  }
  return here;
}

test("the first arrow leads to the box at the top left", () => {
  expect(step(graph, null, "down")).toBe(nodeKey("ocu"));
  expect(step({ ...graph, nodes: [], edges: [] }, null, "down")).toBeNull();
});

test("down and up go through the rows of a box", () => {
  expect(walk(nodeKey("ocu"), "down")).toBe(portKey("ocu", "drive"));
  expect(walk(nodeKey("ocu"), "down", "down")).toBe(portKey("ocu", "pose"));
  expect(walk(portKey("ocu", "drive"), "up")).toBe(nodeKey("ocu"));
});

test("right follows the line of a row to the row at its end, left leads back", () => {
  expect(walk(portKey("ocu", "drive"), "right")).toBe(edgeKey("e1"));
  expect(walk(portKey("ocu", "drive"), "right", "right")).toBe(portKey("bridge", "velocity"));
  expect(walk(portKey("ocu", "drive"), "right", "right", "right", "right")).toBe(
    portKey("base", "/cmd_vel"),
  );
  expect(walk(portKey("bridge", "odometry"), "left", "left")).toBe(portKey("ocu", "pose"));
});

test("up and down on a line go to the other lines at that side of the box", () => {
  expect(walk(portKey("bridge", "velocity"), "right", "down")).toBe(edgeKey("e3"));
  expect(walk(portKey("bridge", "velocity"), "left", "down")).toBe(edgeKey("e4"));
  expect(walk(portKey("bridge", "velocity"), "left", "down", "up", "up")).toBe(edgeKey("e1"));
});

test("without a line an arrow leads to the next box, and nowhere at the border", () => {
  const lonely = { ...graph, edges: [] };
  expect(step(lonely, portKey("ocu", "drive"), "right")).toBe(nodeKey("bridge"));
  expect(step(lonely, nodeKey("ocu"), "left")).toBe(nodeKey("ocu"));
  expect(jump(graph, portKey("ocu", "drive"), "right")).toBe(nodeKey("bridge"));
  expect(jump(graph, edgeKey("e3"), "right")).toBe(nodeKey("base"));
});

test("every part of a graph can be reached by arrows", () => {
  const big = bigGraph(24, 4, 60);
  const seen = new Set<string>();
  const waiting = [step(big, null, "down")];
  for (let here = waiting.pop(); here; here = waiting.pop()) {
    if (seen.has(here)) continue;
    seen.add(here);
    for (const direction of ["up", "down", "left", "right"] as const) {
      waiting.push(step(big, here, direction, here), jump(big, here, direction));
    }
  }
  for (const node of big.nodes) {
    expect(seen).toContain(nodeKey(node.id));
    for (const port of node.ports) expect(seen).toContain(portKey(node.id, port.id));
  }
});

test("downstream of a row is what its line leads to, not what else its box does", () => {
  const down = following(graph, portKey("ocu", "drive"), "down");
  expect([...down].filter((key) => key.startsWith("edge")).sort()).toEqual([
    edgeKey("e1"),
    edgeKey("e2"),
  ]);
  expect(down).toContain(portKey("base", "/cmd_vel"));
  expect(down).not.toContain(portKey("bridge", "odometry"));
  expect(following(graph, portKey("ocu", "pose"), "up")).toContain(portKey("base", "/odom"));
  expect(following(graph, nodeKey("ocu"), "both").size).toBeGreaterThan(10);
});

test("circles end", () => {
  const big = bigGraph(5, 1, 40);
  expect(following(big, nodeKey("box0"), "both").size).toBeGreaterThan(5);
});

test("a filter leaves what has the name, its box and its lines", () => {
  const bright = matching(graph, " ODOM");
  expect(bright).toContain(portKey("bridge", "odometry"));
  expect(bright).toContain(nodeKey("bridge"));
  expect(bright).toContain(edgeKey("e3"));
  expect(bright).not.toContain(nodeKey("ocu"));
  expect(matching(graph, "  ")).toBeNull();
  expect(matches(graph, "odom")).toEqual([portKey("bridge", "odometry"), portKey("base", "/odom")]);
});
