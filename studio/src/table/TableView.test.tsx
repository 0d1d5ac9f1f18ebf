import { render, screen, within } from "@testing-library/preact";
import userEvent from "@testing-library/user-event";
import { beforeEach, expect, test } from "vitest";
import { edgeKey, nodeKey } from "../selection";
import { state, update } from "../store";
import { type FakeServer, serve } from "../testing/fakeServer";
import { smallGraph } from "../testing/graphs";
import { TableView } from "./TableView";

let server: FakeServer;

beforeEach(() => {
  server = serve({ ends: () => ({ ends: [] }) });
  update({ graph: smallGraph() });
});

const lines = () => screen.getByRole("table", { name: "Lines of robot" });
const rows = () => within(lines()).getAllByRole("row").slice(1);
const first = () => rows().map((row) => row.querySelector("td")?.textContent);

test("lines tell from where to where what flows, and are sorted by their heads", async () => {
  render(<TableView />);
  expect(rows()[0]).toHaveTextContent("ocu · drive");
  expect(rows()[0]).toHaveTextContent("bridge · velocity");
  const head = within(lines()).getByRole("columnheader", { name: "From" });
  await userEvent.click(within(head).getByRole("button"));
  expect(head).toHaveAttribute("aria-sort", "ascending");
  expect(first()).toEqual([
    "base · /odom",
    "bridge · odometry",
    "bridge · velocity",
    "ocu · drive",
  ]);
  await userEvent.click(within(head).getByRole("button"));
  expect(head).toHaveAttribute("aria-sort", "descending");
  expect(first()[0]).toBe("ocu · drive");
});

test("it is one tab stop; arrows choose, and keys do what they do in the diagram", async () => {
  render(<TableView />);
  expect(rows().filter((row) => row.tabIndex === 0)).toHaveLength(1);
  rows()[0]?.focus();
  await userEvent.keyboard("{ArrowDown}");
  expect(state().selection).toEqual([edgeKey("e2")]);
  expect(rows()[1]).toHaveFocus();
  await userEvent.keyboard("{End}");
  expect(state().selection).toEqual([edgeKey("e4")]);
  await userEvent.click(screen.getByRole("cell", { name: "drive" }));
  await userEvent.keyboard("c");
  expect(server.params("ends")).toMatchObject([{ node: "ocu", port: "drive" }]);
});

test("boxes stand with their rows, and with what is wrong in words", () => {
  const graph = smallGraph();
  graph.nodes[1]!.findings = [{ severity: "warning", message: "no host" }];
  update({ graph, selection: [nodeKey("bridge")] });
  render(<TableView />);
  const boxes = screen.getByRole("table", { name: "Boxes and their rows" });
  const row = within(boxes).getByRole("row", { current: true });
  expect(row).toHaveTextContent("warning: no host");
  expect(within(boxes).getAllByRole("row")).toHaveLength(1 + 3 + 6);
});
