import { render, screen, within } from "@testing-library/preact";
import userEvent from "@testing-library/user-event";
import { expect, it } from "vitest";
import type { Stepping as Standing, StepChoice } from "../../protocol";
import { isPresent, isTakenLast, state, update } from "../../store";
import { serve } from "../../testing/fakeServer";
import { nameOf, Stepping } from "./Stepping";

const VIEW = "machine:Door.ReceiveFSM";

const choice = (what: string, change: Partial<StepChoice> = {}): StepChoice => ({
  kind: "message",
  actor: "a client",
  what,
  state: "Ready.Open",
  transition: "t1",
  why_not: "",
  ...change,
});

const STANDING: Standing = {
  component: "door",
  tick: 2,
  beside: [],
  conditions: ["isFree"],
  initial: "Ready.Shut",
  taken: [],
  fault: "",
  state: "Ready.Shut",
  status: "READY",
  controller: "a client",
  choices: [
    choice("OpenDoor"),
    choice("CloseDoor", { state: "Ready.Shut", why_not: "no transition takes it in Shut" }),
    choice("passes", { kind: "time", actor: "time", state: "Ready.Shut", transition: "" }),
  ],
};

function show(standing: Partial<Standing> = {}) {
  const server = serve({
    step: ({ path }) => ({
      ...STANDING,
      ...(path.length ? { state: "Ready.Open", taken: [choice("OpenDoor")] } : {}),
      ...standing,
    }),
    "step.test": () => ({ test: "def test_a_path():" }),
  });
  update({ view: VIEW, walk: null, bottom: "step" });
  render(<Stepping />);
  return server;
}

it("takes a step with what conditions say, and goes back", async () => {
  const server = show();
  await userEvent.click(await screen.findByRole("checkbox", { name: "isFree" }));
  await userEvent.click(screen.getByRole("button", { name: "OpenDoor of a client" }));
  expect(await screen.findByText("Ready.Open", { selector: "strong" })).toBeTruthy();
  const step = { actor: "a client", what: "OpenDoor", said: { isFree: true } };
  expect(server.params("step").at(-1)?.path).toEqual([step]);
  expect(isPresent(state(), "m!Ready.Open")).toBe(true);
  expect(isPresent(state(), "m!Ready", true)).toBe(true);
  expect(isPresent(state(), "m!Ready")).toBe(false);
  expect(isTakenLast(state(), "t1")).toBe(true);
  // Beside another panel, such as what runs, nothing is marked as if it ran.
  update({ bottom: "live" });
  expect(isPresent(state(), "m!Ready.Open")).toBe(false);
  update({ bottom: "step" });
  await userEvent.click(screen.getByRole("button", { name: "Back" }));
  expect(await screen.findByText("Ready.Shut", { selector: "strong" })).toBeTruthy();
  update({ view: "system" });
  expect(isPresent(state(), "m!Ready.Shut")).toBe(false);
});

it("shows what has no effect, with the reason, when asked", async () => {
  show();
  await screen.findByRole("button", { name: "OpenDoor of a client" });
  expect(screen.queryByRole("button", { name: "CloseDoor of a client" })).toBeNull();
  await userEvent.click(screen.getByRole("checkbox", { name: "also what has no effect" }));
  const row = screen.getByRole("button", { name: "CloseDoor of a client" }).closest("li")!;
  expect(within(row).getByText("no transition takes it in Shut")).toBeTruthy();
});

it("tells why a path is not possible any more, and what acts beside", async () => {
  show({ fault: "step 1: a client has no OpenDoor any more", beside: ["ReceiveFSM of Spot"] });
  expect((await screen.findByRole("alert")).textContent).toContain("step 1");
  expect(screen.getByText(/ReceiveFSM of Spot may act meanwhile/)).toBeTruthy();
});

it("makes a test of the path", async () => {
  const server = show();
  await userEvent.click(await screen.findByRole("button", { name: "2 s pass" }));
  await userEvent.click(await screen.findByRole("button", { name: "Make a test of it" }));
  expect(await screen.findByText("def test_a_path():")).toBeTruthy();
  expect(server.params("step.test")[0]?.path).toEqual([
    { actor: "time", what: "passes", said: {} },
  ]);
});

it("names steps as people call them", () => {
  expect(nameOf(choice("EndStop", { kind: "event", actor: "winch" }), 1)).toBe("EndStop");
  expect(nameOf(choice("fails", { kind: "core", actor: "winch" }), 1)).toBe("fails");
  expect(nameOf(choice("Resume", { kind: "core" }), 1)).toBe("Resume of a client");
});
