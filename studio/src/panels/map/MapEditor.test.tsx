import { fireEvent, render, screen, waitFor, within } from "@testing-library/preact";
import userEvent from "@testing-library/user-event";
import { beforeEach, expect, it } from "vitest";
import type { ConnectOption, Graph, MapMember } from "../../protocol";
import { state, update } from "../../store";
import { type FakeServer, serve } from "../../testing/fakeServer";
import { edge, node, port, smallGraph } from "../../testing/graphs";
import { MapEditor } from "./MapEditor";
import { dumped } from "./TryIt";

const GRAPH: Graph = {
  ...smallGraph(),
  view: "map:velocity",
  nodes: [
    node("m!jaus", [], {
      title: "ReportVelocityState",
      column: 0,
      ports: [
        port("VelocityX", 30, { note: "float, m/s", mark: "required" }),
        port("YawRate", 48, { mark: "required, unmapped" }),
      ],
    }),
    node("m!ros", [], {
      title: "geometry_msgs/Twist",
      column: 2,
      ports: [port("linear", 30), port("linear.x", 48, { depth: 1 }), port("angular", 66)],
    }),
  ],
  edges: [
    edge("a1", ["m!jaus", "VelocityX"], ["m!ros", "linear.x"], {
      kind: "to_ros",
      title: "VelocityX to linear.x",
      labels: ["scale 2"],
    }),
  ],
};

const member = (path: string, depth = 0): MapMember => ({
  path,
  label: path.split(".").at(-1) ?? path,
  note: "",
  mark: "",
  depth,
});

const option = (label: string, element: string): ConnectOption => ({
  label,
  why: "",
  preview: label,
  commands: [{ kind: "remove", element }],
  is_best: true,
});

let server: FakeServer;

beforeEach(() => {
  server = serve({
    members: () => ({
      sides: [
        {
          node: "m!ros",
          members: ["linear", "linear.x", "linear.y", "angular", "angular.z"].map((path) =>
            member(path, path.includes(".") ? 1 : 0),
          ),
        },
      ],
    }),
    connect: () => ({ options: [], refusal: "they do not fit" }),
    fill: ({ value }) => ({
      constant:
        value === "x"
          ? { options: [], refusal: "'x' is no number" }
          : { options: [option("constant", value)], refusal: "" },
      clock: { options: [], refusal: "it is no time" },
      ignore: { options: [option("leave out", "")], refusal: "" },
    }),
    edit: () => ({ revision: 1, created: [] }),
    tried: ({ direction }) => ({
      inputs:
        direction === "to_ros"
          ? [{ path: "VelocityX", type: "float", unit: "m/s", default: "0" }]
          : [],
    }),
    try: ({ values }) =>
      values.VelocityX === "x"
        ? { values: [], bytes: "", error: "'x' is no number", notes: [] }
        : {
            values: [{ path: "linear.x", value: values.VelocityX ?? "0", unit: "m/s" }],
            bytes: "0102ff",
            error: "",
            notes: [],
          },
  });
  update({ view: "map:velocity", graph: GRAPH });
  render(<MapEditor />);
});

const row = (name: RegExp) => screen.findByRole("treeitem", { name });
const ends = () => server.params("connect").map(({ source, target }) => [source.port, target.port]);

it("shows all members of both ends, open where something is mapped", async () => {
  await row(/^linear/);
  const ros = screen.getByRole("tree", { name: "Members of geometry_msgs/Twist" });
  const names = within(ros)
    .getAllByRole("treeitem")
    .map((element) => element.dataset.row);
  expect(names).toEqual(["linear", "linear.x", "linear.y", "angular"]);
  expect(await row(/^VelocityX/)).toHaveTextContent("→ linear.x: scale 2");
  expect(await row(/^YawRate/)).toHaveTextContent("required, unmapped");
});

it("maps a member onto another by dragging", async () => {
  const data = new Map<string, string>();
  const dataTransfer = {
    setData: (type: string, text: string) => data.set(type, text),
    getData: (type: string) => data.get(type) ?? "",
    get types() {
      return [...data.keys()];
    },
  };
  fireEvent.dragStart(await row(/^YawRate/), { dataTransfer });
  const target = await row(/^angular/);
  expect(fireEvent.dragOver(target, { dataTransfer })).toBe(false);
  fireEvent.drop(target, { dataTransfer });
  await screen.findByRole("tree", { name: "Members of geometry_msgs/Twist" });
  const refusal = { kind: "connect", refusal: "they do not fit" };
  await waitFor(() => expect(state().dialog).toMatchObject(refusal));
  expect(ends()).toEqual([["YawRate", "angular"]]);
});

it("maps by keyboard alone, and Escape ends it", async () => {
  (await row(/^YawRate/)).focus();
  await userEvent.keyboard("c");
  expect(screen.getByRole("status")).toHaveTextContent("From YawRate");
  await userEvent.keyboard("{Escape}");
  expect(screen.getByRole("status")).not.toHaveTextContent("From");
  await userEvent.keyboard("c");
  (await row(/^angular/)).focus();
  await userEvent.keyboard("{ArrowRight}{ArrowRight}{Enter}");
  expect(ends()).toEqual([["YawRate", "angular.z"]]);
});

it("fills a member without a source, with what the rules accept", async () => {
  (await row(/^angular/)).focus();
  await userEvent.keyboard("f");
  const constant = await screen.findByLabelText("Constant");
  expect(constant).toHaveFocus();
  await userEvent.type(constant, "x");
  expect(await screen.findByText(/'x' is no number/)).toBeVisible();
  // Enter waits for the verdict on what is typed.
  await userEvent.type(constant, "{Backspace}2{Enter}");
  const taken = [{ kind: "remove", element: "2" }];
  await waitFor(() => expect(server.params("edit")[0]?.commands).toEqual(taken));
  await waitFor(() => expect(screen.queryByLabelText("Constant")).toBeNull());
});

it("leaves a member out", async () => {
  (await row(/^angular/)).focus();
  await userEvent.keyboard("f");
  await userEvent.click(await screen.findByRole("button", { name: "leave out" }));
  expect(server.params("edit")[0]?.label).toBe("Fill angular: leave out");
});

it("shows an assignment in the form, and deletes it", async () => {
  await userEvent.click(await screen.findByRole("button", { name: "→ linear.x: scale 2" }));
  expect(state().chosen).toBe("robot.xmi#a1");
  (await row(/^VelocityX/)).focus();
  await userEvent.keyboard("{Delete}");
  expect(server.params("edit")[0]?.commands).toEqual([{ kind: "remove", element: "robot.xmi#a1" }]);
});

it("shows what is not mapped yet", async () => {
  await row(/^VelocityX/);
  await userEvent.selectOptions(screen.getByLabelText("Members shown"), "unmapped members");
  const names = screen.getAllByRole("treeitem").map((element) => element.dataset.row);
  expect(names).toEqual(["YawRate", "linear", "linear.y", "angular", "angular.z"]);
});

it("tries the translation, with its bytes and its faults", async () => {
  await userEvent.click(screen.getByRole("button", { name: "JAUS → ROS" }));
  const input = await screen.findByLabelText("VelocityX");
  await userEvent.type(input, "1.5");
  expect(await screen.findByText("1.5")).toBeVisible();
  expect(screen.getByText("01 02 ff")).toBeVisible();
  await userEvent.clear(input);
  await userEvent.type(input, "x");
  expect(await screen.findByText(/'x' is no number/)).toBeVisible();
});

it("writes bytes sixteen a line", () => {
  expect(dumped("00".repeat(17))).toBe(`${"00 ".repeat(15)}00\n00`);
});
