import { render, screen, within } from "@testing-library/preact";
import { expect, test } from "vitest";
import type { LiveComponent, LiveMachine } from "../../protocol";
import { Machines, shares } from "./Machines";

const MACHINE: LiveMachine = {
  service: "urn:jausml:examples:Winch",
  machine: "ReceiveFSM",
  state: "Receiving.Ready.Moving.PayingOut",
  seconds: 1.5,
  known: true,
  times: [
    { state: "Receiving.Ready.Idle", entries: 2, seconds: 4.5 },
    { state: "Receiving.Ready.Moving.PayingOut", entries: 1, seconds: 1.5 },
  ],
};

function component(machines?: LiveMachine[]): LiveComponent {
  return {
    id: "120.1.1",
    name: "winch",
    level: "ok",
    reason: "",
    state: "READY",
    controller: null,
    round_trip_ms: null,
    machines,
  };
}

test("a row for each machine, and none for components that tell none", () => {
  const { container } = render(<Machines components={[component(), component([])]} />);
  expect(container).toBeEmptyDOMElement();
  render(<Machines components={[component([MACHINE])]} />);
  const row = within(screen.getByRole("row", { name: /winch 120.1.1/ }));
  expect(row.getByText("Winch ReceiveFSM")).toBeTruthy();
  expect(row.getByText("Moving.PayingOut")).toBeTruthy();
});

test("a state that the model does not have is said to be unknown", () => {
  render(<Machines components={[component([{ ...MACHINE, state: "Elsewhere", known: false }])]} />);
  expect(screen.getByText("Elsewhere (unknown to the model)")).toBeTruthy();
});

test("shares of the time, and nothing of no time", () => {
  expect(shares(MACHINE)).toBe("Ready.Idle 75 % (2×), Moving.PayingOut 25 % (1×)");
  expect(shares({ ...MACHINE, times: [] })).toBe("–");
  expect(shares({ ...MACHINE, times: [{ state: "A", entries: 1, seconds: 0 }] })).toBe("A (1×)");
});
