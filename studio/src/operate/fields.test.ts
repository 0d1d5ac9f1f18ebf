import { expect, it } from "vitest";
import { axesOf, type Faults, faultOfFull, readGroup, valueAt, withNumber } from "./fields";
import type { Field } from "./protocol";

const number = (name: string, more: object = {}): Field =>
  ({
    name,
    documentation: "",
    optional: false,
    kind: "number",
    integer: false,
    ranges: [[-100, 100]],
    choices: [],
    units: "%",
    ...more,
  }) as Field;
const BODY: Field[] = [
  {
    name: "Rec",
    documentation: "",
    optional: false,
    kind: "group",
    members: [number("X"), number("Y", { optional: true }), number("N", { integer: true })],
  },
];

function read(draft: object, fields = BODY): [unknown, Record<string, string>] {
  const faults: Faults = new Map();
  const value = readGroup(fields, draft as never, "", faults);
  return [value, Object.fromEntries(faults)];
}

it("makes what was typed a message, and leaves out what may be absent", () => {
  expect(read({ Rec: { X: "20", N: "3" } })).toEqual([{ Rec: { X: 20, N: 3 } }, {}]);
});

it("fills nothing in: what is needed and was not typed is a fault at its field", () => {
  expect(read({})[1]).toEqual({ "Rec.X": "This is needed.", "Rec.N": "This is needed." });
});

it.each([
  ["200", "200 is not within -100 .. 100 %."],
  ["-100.01", "-100.01 is not within -100 .. 100 %."],
  ["fast", "fast is no number."],
  ["Infinity", "Infinity is no number."],
])("refuses %s at its field", (typed, fault) => {
  expect(read({ Rec: { X: typed, N: "3" } })[1]).toEqual({ "Rec.X": fault });
});

it("refuses a whole number that would be sent as another one", () => {
  const long = [number("N", { integer: true, ranges: [[0, 2 ** 64]] })];
  expect(read({ N: "9007199254740991" }, long)[1]).toEqual({});
  expect(read({ N: "9007199254740993" }, long)[1]).toEqual({
    N: "9007199254740993 has more digits than can be sent.",
  });
});

it("refuses fractions of whole numbers, and numbers between ranges", () => {
  const gaps = [
    number("N", {
      integer: true,
      ranges: [
        [0, 1],
        [5, 9],
      ],
      units: "",
    }),
  ];
  expect(read({ N: "1.5" }, gaps)[1]).toEqual({ N: "1.5 is no whole number." });
  expect(read({ N: "3" }, gaps)[1]).toEqual({ N: "3 is not within 0 .. 1, 5 .. 9." });
  expect(read({ N: "7" }, gaps)).toEqual([{ N: 7 }, {}]);
});

it("reads lists, variants, types and bytes", () => {
  const plain = { documentation: "", optional: false };
  const fields: Field[] = [
    { ...plain, name: "L", kind: "list", least: 1, most: 2, element: number("E") },
    { ...plain, name: "V", kind: "variant", options: [number("A"), number("B")] },
    { ...plain, name: "O", kind: "octets", least: 1, most: 2 },
  ];
  const draft = { L: ["1", "2"], V: { _tag: "1", value: "5" }, O: "0a ff" };
  expect(read(draft, fields)).toEqual([
    { L: [1, 2], V: { _tag: 1, B: 5 }, O: { hex: "0aff" } },
    {},
  ]);
  const wrong = read({ L: ["1", "2", "999"], V: { _tag: "" }, O: "0" }, fields)[1];
  expect(Object.keys(wrong)).toEqual(["L", "L[2]", "V", "O"]);
});

it("lets a stick move numbers, among what was typed", () => {
  expect(axesOf(BODY).map((axis) => axis.steps.join("."))).toEqual(["Rec.X", "Rec.Y", "Rec.N"]);
  const moved = withNumber({ Rec: { N: "3" } }, ["Rec", "X"], 12.5);
  expect(read(moved as object)).toEqual([{ Rec: { X: 12.5, N: 3 } }, {}]);
});

const ranged = (low: number, high: number, integer = false): Field & { kind: "number" } => ({
  name: "Speed",
  documentation: "",
  optional: false,
  kind: "number",
  integer,
  ranges: [[low, high]],
  choices: [],
  units: "",
});

it("has a stick for a range of one side, whose other side is 0", () => {
  const speed = ranged(0, 4000, true);
  expect(axesOf([speed])).toHaveLength(1);
  expect(valueAt(speed, 0.5, 1501)).toBe(751);
  expect(valueAt(speed, -1, 1500)).toBe(0);
  expect(faultOfFull(speed, "1500")).toBe("");
  expect(faultOfFull(speed, "5000")).toMatch("not within 0 .. 4000");
  expect(axesOf([ranged(5, 10)])).toEqual([]);
});
