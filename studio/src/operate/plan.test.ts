import { expect, it } from "vitest";
import { around, barOf, FRAMES, paired } from "./plan";

const [local, global] = FRAMES;

it("has x up and y right of a local pose", () => {
  expect(local?.pointOf(3, -4, [0, 0])).toEqual({ up: 3, right: -4 });
});

it("has north up and east right of a global pose, in metres", () => {
  // A minute of latitude is about 1853 m; at 60 degrees one of longitude is half of it.
  const north = global?.pointOf(60 + 1 / 60, 10, [60, 10]);
  expect(north?.up).toBeCloseTo(1853.3, 0);
  expect(north?.right).toBeCloseTo(0, 6);
  const east = global?.pointOf(60, 10 + 1 / 60, [60, 10]);
  expect(east?.up).toBeCloseTo(0, 6);
  expect(east?.right).toBeCloseTo(926.6, 0);
});

it("takes numbers of the same reports alone", () => {
  const x = { times: [1, 2, 3], values: [10, 20, 30] };
  const y = { times: [2, 3, 4], values: [-2, -3, -4] };
  expect(paired(x, y)).toEqual([
    [20, -2],
    [30, -3],
  ]);
});

it("is as large as its points, and no smaller than some metres", () => {
  expect(around([{ up: 0, right: 0 }], 10)).toEqual([-5, -5, 10]);
  const [left, top, size] = around(
    [
      { up: 0, right: 0 },
      { up: 100, right: 50 },
    ],
    10,
  );
  expect(size).toBeCloseTo(120);
  expect([left, top]).toEqual([-35, -110]);
});

it.each([
  [10, 2],
  [100, 20],
  [4, 1],
  [90, 20],
])("has a bar of a round length for %d m", (width, bar) => {
  expect(barOf(width)).toBe(bar);
});
