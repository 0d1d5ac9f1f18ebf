import { expect, test } from "vitest";
import { node } from "../testing/graphs";
import { aligned } from "./aligning";

const boxes = [
  node("a", [], { x: 0, y: 0, width: 100, height: 30 }),
  node("b", [], { x: 300, y: 50, width: 60, height: 40 }),
  node("c", [], { x: 110, y: 200, width: 100, height: 50 }),
];

test("boxes come in line with the outermost, and those that stand there do not move", () => {
  expect(aligned(boxes, "left")).toEqual({ "key:b": [0, 50], "key:c": [0, 200] });
  expect(aligned(boxes, "right")).toEqual({ "key:a": [260, 0], "key:c": [260, 200] });
  expect(aligned(boxes, "top")).toEqual({ "key:b": [300, 0], "key:c": [110, 0] });
  expect(aligned(boxes, "bottom")).toEqual({ "key:a": [0, 220], "key:b": [300, 210] });
  expect(aligned(boxes, "centre")).toMatchObject({ "key:a": [130, 0], "key:b": [150, 50] });
  expect(aligned(boxes, "middle")).toMatchObject({ "key:a": [0, 110] });
});

test("gaps become the same, whatever the sizes; the outermost stay", () => {
  expect(aligned(boxes, "across")).toEqual({ "key:c": [150, 200] });
  expect(aligned(boxes, "down")).toEqual({ "key:b": [300, 95] });
  expect(aligned([boxes[0]!], "across")).toEqual({});
});
