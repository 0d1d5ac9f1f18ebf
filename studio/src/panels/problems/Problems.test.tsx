import { act, render, screen } from "@testing-library/preact";
import userEvent from "@testing-library/user-event";
import { beforeEach, expect, it } from "vitest";
import type { Problem } from "../../protocol";
import { state, update } from "../../store";
import { type FakeServer, PROJECT, serve } from "../../testing/fakeServer";
import { verdict } from "../../verdicts";
import { Problems } from "./Problems";

function problem(
  severity: Problem["severity"],
  message: string,
  more: Partial<Problem> = {},
): Problem {
  return {
    file: "robot.xmi",
    line: 3,
    column: 1,
    severity,
    rule: "rule-x",
    message,
    hint: "",
    element: "robot.xmi#a",
    path: "robot/bridge",
    cures: [],
    ...more,
  };
}

const CURE = {
  label: "Set stopRos",
  commands: [{ kind: "remove" as const, element: "robot.xmi#a" }],
};
const PROBLEMS = [
  problem("info", "could be shorter", { line: 1 }),
  problem("warning", "no safe value", { cures: [CURE], hint: "say what stops it" }),
  problem("error", "no such member", { line: 9, rule: "map-member" }),
];

let server: FakeServer;

beforeEach(() => {
  server = serve({ edit: () => ({ revision: 1, created: [] }) });
  update({ problems: { revision: 1, elapsed_ms: 41.6, problems: PROBLEMS } });
  render(<Problems />);
});

const shown = () => screen.queryAllByRole("listitem").map((element) => element.textContent ?? "");

it("lists the gravest first, with counts and the time that it took", () => {
  expect(shown().map((line) => line.slice(0, 8))).toEqual(["✖ errorn", "▲ warnin", "● infoco"]);
  expect(screen.getByRole("status")).toHaveTextContent("1 error, 1 warning, 1 remark.");
  expect(screen.getByText("checked in 42 ms")).toBeVisible();
  expect(screen.getByText("robot/bridge · robot.xmi:9 · map-member")).toBeVisible();
});

it("filters by severity and by words", async () => {
  await userEvent.click(screen.getByRole("checkbox", { name: "1 warning" }));
  expect(shown()).toHaveLength(2);
  await userEvent.type(screen.getByRole("searchbox"), "member no");
  expect(shown()).toHaveLength(1);
  await userEvent.type(screen.getByRole("searchbox"), " nowhere");
  expect(screen.getByText("All problems are filtered out.")).toBeVisible();
});

it("goes to the element", async () => {
  await userEvent.click(screen.getByRole("button", { name: "no such member" }));
  expect(state().chosen).toBe("robot.xmi#a");
});

it("cures in one step", async () => {
  await userEvent.click(screen.getByRole("button", { name: "Set stopRos" }));
  expect(server.params("edit")[0]).toMatchObject({
    commands: CURE.commands,
    label: "Set stopRos",
    base: 1,
  });
});

it("says so when there is nothing to say", () => {
  expect(verdict([])).toBe("No problems.");
});

it("gives no verdict on what cannot be read", () => {
  const fault = "robot.xmi cannot be read as it is";
  const report = { revision: 2, elapsed_ms: 1, problems: [] };
  act(() => update({ problems: { ...report, fault } }));
  expect(screen.getByRole("status")).toHaveTextContent(`Not checked: ${fault}.`);
  expect(screen.queryByText(/No problems|checked in/)).toBeNull();
});

it("tells a verdict on former files as one", () => {
  act(() => update({ project: { ...PROJECT, revision: 9 } }));
  expect(screen.getByText("of revision 1; checking again…")).toBeVisible();
});
