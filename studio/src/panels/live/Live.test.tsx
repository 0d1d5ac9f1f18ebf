import { act, render, screen } from "@testing-library/preact";
import userEvent from "@testing-library/user-event";
import { expect, it, vi } from "vitest";
import { listener } from "../../actions";
import type { LiveState } from "../../protocol";
import { edgeKey, portKey } from "../../selection";
import { state, update } from "../../store";
import { serve } from "../../testing/fakeServer";
import { counted, Live, rates } from "./Live";

const LIVE: LiveState = {
  health: "warning",
  sources: { "/diagnostics": "heard", JAUS: "port in use" },
  connections: [
    {
      bridge: "bridge",
      connection: "velocity",
      row: "conn1",
      level: "warning",
      reason: "too slow",
      rate: 4.21,
      declared_rate: 10,
      age: 0.2,
      latency_us: { mean: 120.4 },
      drops: { late: 3, invalid: 0 },
      told: 0.1,
    },
  ],
  components: [
    {
      id: "100.1.1",
      name: "vehicle",
      level: "ok",
      reason: "",
      state: "Ready",
      controller: "200.1.1",
      round_trip_ms: 1.5,
    },
  ],
  edges: {},
  boxes: {},
};

function show() {
  const server = serve({
    "live.start": () => null,
    "live.stop": () => null,
    "live.message": () => ({ jaus: "VelocityX: 1.0 m/s", ros: "twist.linear.x: 1.0", age: 0.25 }),
  });
  render(<Live />);
  return server;
}

it("opens the connection whose row or line is chosen in the diagram", async () => {
  const server = show();
  act(() => update({ live: LIVE }));
  expect(screen.queryByText("VelocityX: 1.0 m/s")).toBeNull();
  act(() => update({ selection: [edgeKey("conn1!ocu")] }));
  expect(await screen.findByText("VelocityX: 1.0 m/s")).toBeVisible();
  expect(server.params("live.message")[0]).toEqual({ connection: "conn1" });
  act(() => update({ selection: [portKey("bridge", "conn1")] }));
  expect(screen.getByRole("button", { name: "bridge/velocity" })).toHaveAttribute(
    "aria-expanded",
    "true",
  );
});

it("watches, and stops to watch", async () => {
  const server = show();
  await userEvent.click(screen.getByRole("button", { name: "Watch" }));
  expect(server.params("live.start")).toEqual([{ file: "robot.xmi" }]);
  await userEvent.click(await screen.findByRole("button", { name: "Stop watching" }));
  expect(server.params("live.stop")).toHaveLength(1);
  expect(state().live).toBeNull();
});

it("tells connections and components, with what is wrong in words", () => {
  show();
  act(() => update({ live: LIVE }));
  expect(screen.getByText("4.21 of 10 Hz")).toBeVisible();
  expect(screen.getByText("late 3")).toBeVisible();
  expect(screen.getByText("mean 120 µs")).toBeVisible();
  expect(screen.getByRole("row", { name: /velocity/ })).toHaveTextContent("warning too slow");
  expect(screen.getByRole("row", { name: /vehicle/ })).toHaveTextContent("200.1.1");
  expect(screen.getByText("JAUS: port in use")).toBeVisible();
});

it("shows the last message on both sides", async () => {
  const server = show();
  act(() => update({ live: LIVE }));
  await userEvent.click(screen.getByRole("button", { name: "bridge/velocity" }));
  expect(await screen.findByText("VelocityX: 1.0 m/s")).toBeVisible();
  expect(screen.getByText("twist.linear.x: 1.0")).toBeVisible();
  expect(server.params("live.message")[0]).toEqual({ connection: "conn1" });
});

it("says nothing where nothing is known", () => {
  expect(rates({ rate: null, declared_rate: null })).toBe("– Hz");
  expect(counted({ late: 0 })).toBe("–");
});

it("tells values as old when no new ones come, also where the clock is set back", () => {
  vi.useFakeTimers({ toFake: ["setInterval", "clearInterval", "Date"] });
  let now = 1000;
  vi.spyOn(performance, "now").mockImplementation(() => now);
  const pass = (milliseconds: number) => {
    now += milliseconds;
    act(() => void vi.advanceTimersByTime(milliseconds));
  };
  try {
    show();
    act(() => listener.onNotification("live", { state: LIVE }));
    expect(screen.queryByRole("alert")).toBeNull();
    vi.setSystemTime(Date.now() - 60_000);
    pass(6000);
    expect(screen.getByRole("alert")).toHaveTextContent("stale: nothing was told for 6 s");
    act(() => listener.onNotification("live", { state: LIVE }));
    pass(1000);
    expect(screen.queryByRole("alert")).toBeNull();
    act(() => update({ link: "lost" }));
    expect(screen.getByRole("alert")).toBeVisible();
  } finally {
    vi.useRealTimers();
  }
});
