import { beforeEach, expect, it } from "vitest";
import {
  type Drawing,
  driversOf,
  load,
  movedTo,
  NOTHING,
  placeIn,
  progressOf,
  readWaypoints,
  save,
} from "./drawing";
import type { Field } from "./protocol";

const number = (name: string, most: number, optional = false): Field => ({
  name,
  documentation: "",
  optional,
  kind: "number",
  integer: false,
  ranges: [[-most, most]],
  choices: [],
  units: "m",
});
const FIELDS: Field[] = [
  {
    name: "LocalWaypointRec",
    documentation: "",
    optional: false,
    kind: "group",
    members: [number("X", 100000), number("Y", 100000), number("Z", 100000, true)],
  },
];
const [driver] = driversOf(["Events", "LocalWaypointListDriver"], ["ExecuteList"]);
if (!driver) throw new Error("there is no driver");
const { frame } = driver;

beforeEach(() => localStorage.clear());

it("knows the drivers of lists before those of one waypoint", () => {
  const services = ["GlobalWaypointDriver", "LocalWaypointDriver", "GlobalWaypointListDriver", "X"];
  const listed = (...taken: string[]) =>
    driversOf(services, taken).map((candidate) => [candidate.service, candidate.execution]);
  expect(listed("ExecuteList", "SetTravelSpeed")).toEqual([
    ["GlobalWaypointListDriver", "ExecuteList"],
    ["LocalWaypointDriver", "SetTravelSpeed"],
    ["GlobalWaypointDriver", "SetTravelSpeed"],
  ]);
  expect(listed("ExecuteList")).toContainEqual(["LocalWaypointDriver", undefined]);
});

it("makes the fields of what is drawn, and no other ones", () => {
  const drawn = movedTo({}, FIELDS, frame, [3, -4]);
  expect(placeIn(drawn, FIELDS, frame)).toEqual([3, -4]);
  expect(readWaypoints(FIELDS, [drawn]).values).toEqual([{ LocalWaypointRec: { X: 3, Y: -4 } }]);
});

it("keeps the other fields of a waypoint that is moved", () => {
  const drawn = movedTo({ LocalWaypointRec: { Z: "1.5" } }, FIELDS, frame, [1, 2]);
  const { values } = readWaypoints(FIELDS, [drawn]);
  expect(values).toEqual([{ LocalWaypointRec: { X: 1, Y: 2, Z: 1.5 } }]);
});

it("says at which waypoint a number is wrong", () => {
  const far = { LocalWaypointRec: { X: "200000", Y: "0" } };
  const { faults } = readWaypoints(FIELDS, [movedTo({}, FIELDS, frame, [1, 2]), far, {}]);
  expect([...faults.keys()]).toEqual([
    "elements[1].LocalWaypointRec.X",
    "elements[2].LocalWaypointRec.X",
    "elements[2].LocalWaypointRec.Y",
  ]);
  expect(placeIn(far, FIELDS, frame)).toBeUndefined();
});

it("is there again for the same component and driver alone", () => {
  const drawing: Drawing = { ...NOTHING, waypoints: [movedTo({}, FIELDS, frame, [1, 2])] };
  save(localStorage, "100.1.10", driver, drawing);
  expect(load(localStorage, "100.1.10", driver)).toEqual(drawing);
  expect(load(localStorage, "100.1.11", driver)).toEqual(NOTHING);
});

it.each(["{", "null", "[]", '{"waypoints": 3}'])("takes %s for nothing that was drawn", (text) => {
  localStorage.setItem("jausml-drawing 1.1.1 LocalWaypointListDriver", text);
  expect(load(localStorage, "1.1.1", driver)).toEqual(NOTHING);
});

const executed: Drawing = { ...NOTHING, execution: { time: 10, first: 2 } };
it.each([
  [[], 0, [], "not told"],
  [[0], 0, [], "executes no element"],
  [[2], 2, [], "drives to waypoint 2 of 4"],
  [[2, 3, 4], 4, [2, 3], "drives to waypoint 4 of 4"],
  [[2, 3, 4, 0], 0, [2, 3, 4], "Ended behind the last"],
  [[2, 3, 0, 0], 0, [2], "Ended on the way to waypoint 3 of 4"],
  [[9], 9, [], "another list"],
])("tells of the active elements %s", (values, active, reached, text) => {
  // What was told before it was executed is of another list.
  const times = [1, 2, ...values.map((_, index) => 11 + index)];
  const progress = progressOf(executed, 4, { times, values: [4, 0, ...values] });
  expect(progress?.active).toBe(active);
  expect([1, 2, 3, 4].filter((uid) => progress?.isReached(uid))).toEqual(reached);
  expect(progress?.text).toContain(text);
});
