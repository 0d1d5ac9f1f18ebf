import { render, screen, waitFor } from "@testing-library/preact";
import userEvent from "@testing-library/user-event";
import { beforeEach, expect, test } from "vitest";
import type { OutlineRow } from "../../protocol";
import { portKey } from "../../selection";
import { state, update } from "../../store";
import { type FakeServer, serve } from "../../testing/fakeServer";
import { smallGraph } from "../../testing/graphs";
import { Outline } from "./Outline";

const row = (name: string, depth: number, more: Partial<OutlineRow> = {}): OutlineRow => ({
  element: `robot.xmi#${name}`,
  label: name,
  kind: "component",
  depth,
  inner: 0,
  is_open: false,
  note: "",
  ...more,
});

let server: FakeServer;

beforeEach(() => {
  server = serve({
    outline: ({ query, opened }) => {
      if (query) return { rows: [row(query, 0, { note: "robot" })] };
      const isOpen = opened.includes("robot.xmi#ocu");
      return {
        rows: [
          row("robot", 0, { inner: 2, is_open: true }),
          row("ocu", 1, { inner: 1, is_open: isOpen }),
          ...(isOpen ? [row("drive", 2)] : []),
          row("9 more", 1, { element: "", kind: "" }),
        ],
      };
    },
  });
  update({ graph: smallGraph() });
  render(<Outline />);
});

test("arrows open and close, and Enter chooses what stands there, with its row in the diagram", async () => {
  const ocu = await screen.findByRole("treeitem", { name: /ocu/ });
  screen.getByRole("treeitem", { name: /robot/ }).focus();
  await userEvent.keyboard("{ArrowDown}");
  expect(ocu).toHaveFocus();
  expect(ocu).toHaveAttribute("aria-expanded", "false");
  await userEvent.keyboard("{ArrowRight}");
  const drive = await screen.findByRole("treeitem", { name: /drive/ });
  expect(drive).toHaveAttribute("aria-level", "3");
  await userEvent.keyboard("{ArrowRight}");
  expect(drive).toHaveFocus();
  await userEvent.keyboard("{Enter}");
  expect(state()).toMatchObject({ chosen: "robot.xmi#drive", right: "form" });
  expect(state().selection).toEqual([portKey("ocu", "drive")]);
  expect(drive).toHaveAttribute("aria-selected", "true");
  await userEvent.keyboard("{ArrowLeft}{ArrowLeft}");
  await waitFor(() => expect(screen.queryByRole("treeitem", { name: /drive/ })).toBeNull());
});

test("what no diagram shows is found by name, and how much more there is cannot be chosen", async () => {
  await userEvent.click(await screen.findByText("9 more"));
  expect(state().chosen).toBe("");
  await userEvent.type(screen.getByRole("searchbox"), "placement");
  await waitFor(() => expect(screen.getAllByRole("treeitem")).toHaveLength(1));
  await userEvent.keyboard("{Enter}");
  expect(state().chosen).toBe("robot.xmi#placement");
  expect(server.params("outline").at(-1)).toMatchObject({ query: "placement" });
});

test("Enter takes what was typed, and nothing that stands there while it is searched", async () => {
  await screen.findByRole("treeitem", { name: /robot/ });
  await userEvent.type(screen.getByRole("searchbox"), "placement{Enter}");
  expect(state().chosen).toBe("");
  await waitFor(() => expect(state().chosen).toBe("robot.xmi#placement"));
});
