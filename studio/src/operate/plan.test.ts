import { expect, it } from "vitest";
import {
  around,
  barOf,
  FRAMES,
  type Frame,
  lengthOf,
  type Place,
  paired,
  placeOf,
  refusalAround,
} from "./plan";

const [local, global] = FRAMES as [Frame, Frame];

it("has x up and y right of a local pose", () => {
  expect(local.pointOf(3, -4, [0, 0])).toEqual({ up: 3, right: -4 });
});

// Metres of a degree on WGS 84, as tables have them.
it.each([
  [0, 110_574.3, 111_319.5],
  [45, 111_131.7, 78_846.8],
  [60, 111_412.3, 55_800.0],
  [-60, 111_412.3, 55_800.0],
])("has north up and east right of a global pose, in metres, at %d degrees", (at, north, east) => {
  const [up, right] = [
    global.pointOf(at + 0.01, 10, [at, 10]),
    global.pointOf(at, 10.01, [at, 10]),
  ];
  expect(up.up).toBeCloseTo(north / 100, 1);
  expect(up.right).toBeCloseTo(0, 6);
  expect(right.right).toBeCloseTo(east / 100, 1);
  expect(right.up).toBeCloseTo(0, 6);
});

it("has what is drawn north and east in the places of the fields, with their signs", () => {
  expect(placeOf(local, { up: 3, right: -4 }, [0, 0])).toEqual([3, -4]);
  const [latitude, longitude] = placeOf(
    global,
    { up: 1105.743, right: -1113.195 },
    [0, 0],
  ) as Place;
  expect(latitude).toBeCloseTo(0.01, 6);
  expect(longitude).toBeCloseTo(-0.01, 6);
});

it("goes across the date line on the short way", () => {
  const origin: Place = [0, 179.999];
  expect(global.pointOf(0, -179.999, origin).right).toBeCloseTo(222.6, 1);
  const place = placeOf(global, { up: 0, right: 222.639 }, origin) as Place;
  expect(place[1]).toBeCloseTo(-179.999, 6);
  expect(lengthOf(global, [origin, [0, -179.999]])).toBeCloseTo(222.6, 1);
});

it("draws nothing near the poles, and nothing far away", () => {
  expect(refusalAround(global, [80.1, 0])).toContain("80 degrees");
  expect(refusalAround(global, [-80.1, 0])).toContain("80 degrees");
  expect(refusalAround(local, [90_000, 0])).toBe("");
  expect(placeOf(global, { up: 15_000, right: 0 }, [79.9, 0])).toContain("80 degrees");
  expect(placeOf(global, { up: 0, right: 20_001 }, [0, 0])).toContain("20 km");
});

it("is found again where it was drawn", () => {
  for (const north of [-79, -33.5, 0, 48, 79]) {
    for (const east of [-180, -71.25, 0, 179.9999]) {
      for (const [up, right] of [
        [100, -250],
        [-1000, 1000],
      ] as const) {
        const place = placeOf(global, { up, right }, [north, east]) as Place;
        const again = global.pointOf(...place, [north, east]);
        expect(again.up).toBeCloseTo(up, 1);
        expect(again.right).toBeCloseTo(right, 1);
        expect(Math.abs(place[1])).toBeLessThanOrEqual(180);
      }
    }
  }
});

it("is as long as its legs", () => {
  expect(
    lengthOf(local, [
      [0, 0],
      [3, 4],
      [3, 10],
    ]),
  ).toBe(11);
  expect(lengthOf(local, [])).toBe(0);
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
