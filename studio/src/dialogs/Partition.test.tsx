import { render, screen, waitFor } from "@testing-library/preact";
import userEvent from "@testing-library/user-event";
import { beforeEach, expect, test } from "vitest";
import { carriedBy, carry, offerBridges } from "../actions";
import type { Partition as Plan, PlannedBridge } from "../protocol";
import { portKey } from "../selection";
import { state, update } from "../store";
import { type FakeServer, serve } from "../testing/fakeServer";
import { smallGraph } from "../testing/graphs";
import { Dialogs } from "./Dialogs";

let server: FakeServer;

function bridge(name: string, connections: string[]): PlannedBridge {
  const figures = { processor_share: 0.01, datagrams_per_s: 50, bytes_between_hosts_per_s: 0 };
  return { name, host: "", connections, ...figures, wait_s: 1e-4, reasons: [] };
}

const PLAN: Plan = {
  before: [bridge("main", ["main.go", "main.see"])],
  after: [bridge("main", ["main.go"]), bridge("main_2", ["main.see"])],
  moved: { "main.see": "main_2" },
  faults: [],
  excess: [],
  commands: [{ kind: "remove", element: "x" }],
  revision: 1,
};

beforeEach(() => {
  const graph = smallGraph();
  server = serve({
    views: () => ({ views: [{ name: "system", kind: "system", title: "", library: false }] }),
    view: () => ({ revision: 1, graph }),
    edit: () => ({ revision: 1, entry: null, created: [] }),
    partition: () => PLAN,
  });
  update({ graph, revision: 1, selection: [], dialog: null });
});

test("a proposal is seen before and after, changed, and taken as one edit", async () => {
  update({ dialog: { kind: "partition" } });
  render(<Dialogs />);
  expect(await screen.findAllByText("main_2")).not.toHaveLength(0);
  await userEvent.selectOptions(screen.getByLabelText(/main\.go/), "main_2");
  await waitFor(() =>
    expect(server.params("partition").at(-1)?.names).toEqual({
      "main.go": "main_2",
      "main.see": "main_2",
    }),
  );
  await userEvent.click(await screen.findByRole("button", { name: "Take it" }));
  await waitFor(() => expect(server.params("edit")).toHaveLength(1));
  expect(server.params("edit")[0]).toMatchObject({ commands: PLAN.commands, base: 1 });
});

test("what cannot be is told, and not taken", async () => {
  server.answer("partition", () => ({ ...PLAN, commands: [], faults: ["go and see: together"] }));
  update({ dialog: { kind: "partition" } });
  render(<Dialogs />);
  expect(await screen.findByText("go and see: together")).toBeInTheDocument();
  await userEvent.click(screen.getByRole("button", { name: "Take it" }));
  expect(server.params("edit")).toHaveLength(0);
});

test("rows of a bridge go to another one; what goes along is asked for", async () => {
  const graph = state().graph;
  const main = graph?.nodes.find((node) => node.kind === "bridge");
  const [first, second] = main?.ports ?? [];
  if (!graph || !main || !first || !second) throw new Error("the graph has a bridge of two");
  const keys = [portKey(main.id, first.id), portKey(main.id, second.id)];
  expect(carriedBy(keys[0])).toEqual([first.element]);
  update({ selection: keys });
  expect(carriedBy(keys[0])).toEqual([first.element, second.element]);
  const option = { label: "Move", why: "", preview: "", commands: PLAN.commands, is_best: false };
  server.answer("carry", () => option);
  offerBridges();
  render(<Dialogs />);
  await userEvent.click(screen.getByText("a new bridge"));
  await waitFor(() => expect(server.params("edit")).toHaveLength(1));
  server.answer("carry", () => ({ ...option, why: "they share a stop" }));
  await carry([first.element], main.id);
  expect(await screen.findByText("they share a stop")).toBeInTheDocument();
  expect(server.params("edit").filter((sent) => !sent.dry)).toHaveLength(1);
  expect(server.params("carry").map((sent) => sent.bridge)).toEqual(["", main.element]);
});
