import { act, render, screen, waitFor } from "@testing-library/preact";
import userEvent from "@testing-library/user-event";
import { beforeEach, expect, test } from "vitest";
import { Components } from "./Components";
import DrawingPanel from "./Drawing";
import { driversOf } from "./drawing";
import Media from "./Media";
import { Operate } from "./Operate";
import type { Field, UnitState } from "./protocol";
import { StickPad } from "./StickPad";
import { setCaller, stop, unit, useUnit } from "./unit";

const asked: [string, unknown][] = [];
const COMPONENT = "1.1.1";

const record = (...names: string[]): Field => ({
  name: "Rec",
  documentation: "",
  optional: false,
  kind: "group",
  members: names.map((name) => ({
    name,
    documentation: "",
    optional: false,
    kind: "number",
    integer: false,
    ranges: [[-1000, 1000]],
    choices: [],
    units: "m",
  })),
});

beforeEach(() => {
  asked.length = 0;
  localStorage.clear();
  useUnit.setState(useUnit.getInitialState(), true);
  setCaller({
    call: async (method, params) => {
      asked.push([method, params]);
      const { message } = params as { message?: string };
      if (method === "form")
        return { fields: [message === "ExecuteList" ? record("Speed") : record("X", "Y")] };
      return { values: [], times: [], entries: [], url: "data:", time: 1 };
    },
  });
});

const command = () =>
  useUnit.setState({
    chosen: COMPONENT,
    page: 1,
    mayCommand: true,
    state: { commander: { page: 1 }, holds: [{ component: COMPONENT }] } as UnitState,
  });

test("nothing is said of the unit before its first word but why there is none", async () => {
  render(<Operate />);
  const [header] = screen.getAllByRole("banner");
  expect(header).toHaveTextContent(/^OperateWho commands is not known$/);
  const refusal = "The server does not know this page.";
  await act(() => useUnit.setState({ link: "refused", refusal }));
  expect(header).toHaveTextContent(refusal);
});

test("a stop says when it was, and that it worked only where that is confirmed", async () => {
  const outcome = (confirmed: boolean) => ({ component: "1.1.1", outcome: "READY", confirmed });
  for (const [stopped, said] of [
    [[outcome(true)], /^\d\d:\d\d:\d\d Stopped. 1.1.1: READY/],
    [[outcome(true), outcome(false)], /^\d\d:\d\d:\d\d ✖ Not all is known to stand. 1.1.1/],
  ] as const) {
    setCaller({ call: async () => ({ stopped }) });
    await stop();
    expect(unit().stopping?.outcome).toMatch(said);
  }
});

test("a blank is no authority", async () => {
  command();
  useUnit.setState({ state: { commander: null, holds: [], ages: {} } as unknown as UnitState });
  render(<Components />);
  const user = userEvent.setup();
  await user.type(screen.getByLabelText("Authority, 0 .. 255"), " ");
  expect(screen.getByRole("button", { name: "Take control" })).toBeDisabled();
});

test("a picture grows old while the unit is silent", async () => {
  useUnit.setState({ silence: 60 });
  const none = { fields: [], numbers: [], urls: [] };
  const values = { component: COMPONENT, report: "R", age: 0.25, count: 3, pictures: ["P"] };
  render(<Media values={{ ...values, ...none }} />);
  expect(screen.getByRole("figure")).toHaveTextContent("picture 3, ✝ 60.3 s old");
});

test("two ways of a stick move two numbers", async () => {
  const stick = { stop: "0", timeout: 1, source: "" };
  render(
    <StickPad
      command={{ name: "Set", service: "", documentation: "", stick }}
      component={COMPONENT}
      fields={[record("X", "Y")]}
      draft={{}}
      isAllowed
    />,
  );
  await userEvent.selectOptions(screen.getByLabelText("Up and down"), "Rec.X");
  const offered = screen.getByLabelText("Right and left").querySelectorAll("option");
  expect([...offered].map((option) => option.value)).toEqual(["", "Rec.Y"]);
});

test("a list is executed from the waypoint that is shown", async () => {
  command();
  const [driver] = driversOf(["LocalWaypointListDriver"], ["ExecuteList"]);
  if (!driver) throw new Error("there is no driver");
  const waypoints = ["1", "2", "3"].map((x) => ({ Rec: { X: x, Y: "0" } }));
  const kept = JSON.stringify({ waypoints, origin: [0, 0] });
  localStorage.setItem(`jausml-drawing ${COMPONENT} ${driver.service}`, kept);
  render(<DrawingPanel component={COMPONENT} drivers={[driver]} />);
  const user = userEvent.setup();
  const first = await screen.findByLabelText("from waypoint");
  await user.selectOptions(first, "3");
  await user.type(screen.getByLabelText(/Speed/), "1");
  await user.click(screen.getByRole("button", { name: "Remove waypoint 3" }));
  await user.click(screen.getByRole("button", { name: "Send 2 waypoints" }));
  const execute = screen.getByRole("button", { name: "Execute" });
  await waitFor(() => expect(execute).toBeEnabled());
  expect(first).toHaveValue("1");
  await user.click(execute);
  expect(asked.at(-1)).toEqual(["list.execute", expect.objectContaining({ first: 1 })]);
});

test("a plan on which nothing is left begins where the component is now", async () => {
  const [driver] = driversOf(["GlobalWaypointListDriver"], []);
  if (!driver) throw new Error("there is no driver");
  const key = `jausml-drawing ${COMPONENT} ${driver.service}`;
  const waypoints = [{ Rec: { X: "1", Y: "0" } }];
  localStorage.setItem(key, JSON.stringify({ waypoints, origin: [50, 8] }));
  render(<DrawingPanel component={COMPONENT} drivers={[driver]} />);
  await userEvent.click(await screen.findByRole("button", { name: "Remove waypoint 1" }));
  await waitFor(() =>
    expect(JSON.parse(localStorage.getItem(key) ?? "")).toMatchObject({ origin: null }),
  );
});
