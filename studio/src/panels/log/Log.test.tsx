import { render, screen } from "@testing-library/preact";
import userEvent from "@testing-library/user-event";
import { expect, it } from "vitest";
import { serve } from "../../testing/fakeServer";
import { Log } from "./Log";

const entry = (number: number, label: string) => ({
  number,
  label,
  files: ["robot.xmi"],
  created: [],
});
const ENTRIES = [entry(1, "Add bridge"), entry(2, "Rename it"), entry(3, "Move a box")];

function show(at: number) {
  const server = serve({
    log: () => ({ entries: ENTRIES, at }),
    undo: () => ({ revision: 1, entry: null }),
    redo: () => ({ revision: 1, entry: null }),
  });
  render(<Log />);
  return () =>
    server.asked
      .map((method) => method.method)
      .filter((method) => method === "undo" || method === "redo");
}

it("goes back to any point", async () => {
  const asked = show(3);
  await userEvent.click(await screen.findByRole("button", { name: "Add bridge" }));
  expect(asked()).toEqual(["undo", "undo"]);
});

it("goes forward again, and tells what is undone", async () => {
  const asked = show(0);
  await userEvent.click(await screen.findByRole("button", { name: "Rename it" }));
  expect(asked()).toEqual(["redo", "redo"]);
  expect(screen.getAllByText(/undone/)).toHaveLength(3);
});

it("shows the faults of the studio, with all that is known of them", async () => {
  const fault = { time: 0, level: "error", text: "view failed", details: "Traceback: KeyError" };
  serve({ log: () => ({ entries: [], at: 0 }), faults: () => ({ faults: [fault] }) });
  render(<Log />);
  await userEvent.click(await screen.findByText("Faults (1)"));
  await userEvent.click(screen.getByText(/view failed/));
  expect(screen.getByText("Traceback: KeyError")).toBeVisible();
});
