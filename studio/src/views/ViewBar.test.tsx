import { act, render, screen, waitFor } from "@testing-library/preact";
import userEvent from "@testing-library/user-event";
import { beforeEach, expect, it } from "vitest";
import { onShortcut } from "../keyboard/shortcuts";
import type { Filling, Form, Graph, ViewInfo } from "../protocol";
import { nodeKey } from "../selection";
import { state, update } from "../store";
import { type FakeServer, serve } from "../testing/fakeServer";
import { node, smallGraph } from "../testing/graphs";
import { ViewBar } from "./ViewBar";

const FILLING: Filling = {
  label: "Fill map velocity",
  commands: [{ kind: "remove", element: "robot.xmi#1" }],
  left: { to_ros: ["header.frame_id"], to_jaus: [] },
  refusal: "",
};

const FORM: Form = {
  element: "robot.xmi#machine",
  class: "jaus.StateMachine",
  title: "ReceiveFSM",
  documentation: "",
  readonly: false,
  owner: "",
  fields: [],
  children: [
    {
      feature: "states",
      label: "states",
      many: true,
      documentation: "",
      kinds: [
        { kind: "jaus.State", label: "state", documentation: "", values: { name: ["State"] } },
      ],
      elements: [],
    },
  ],
};

let server: FakeServer;

function open(name: string, more: Partial<Graph> = {}, isLibrary = false) {
  const kind = name.split(":")[0] as ViewInfo["kind"];
  const views = [{ name, kind, title: "x", library: isLibrary }];
  update({ view: name, views, graph: { ...smallGraph(), edges: [], view: name, ...more } });
  render(<ViewBar />);
}

beforeEach(() => {
  server = serve({
    fill_map: () => FILLING,
    form: ({ element }) => ({ ...FORM, element }),
    edit: () => ({ revision: 1, created: [] }),
  });
});

it("fills an empty map by one click and one edit, and tells what is left", async () => {
  open("map:velocity");
  expect(screen.getByRole("status")).toHaveTextContent("This map is empty.");
  await userEvent.click(screen.getByRole("button", { name: "Fill what corresponds" }));
  await waitFor(() =>
    expect(screen.getByRole("status")).toHaveTextContent("1 assignment was added"),
  );
  expect(screen.getByRole("status")).toHaveTextContent("Left to you: header.frame_id.");
  expect(server.params("edit")).toMatchObject([
    { commands: FILLING.commands, label: "Fill map velocity" },
  ]);
  await userEvent.click(screen.getByRole("button", { name: "Show all members" }));
  expect(state().middle).toBe("members");
  act(() => update({ revision: 2 }));
  expect(screen.getByRole("status")).not.toHaveTextContent("Left to you");
});

it("fills it by one key", async () => {
  open("map:velocity");
  document.addEventListener("keydown", onShortcut);
  await userEvent.keyboard("m");
  document.removeEventListener("keydown", onShortcut);
  await waitFor(() => expect(server.params("edit")).toHaveLength(1));
});

it("edits nothing where nothing corresponds, and says so", async () => {
  server.answer("fill_map", () => ({ ...FILLING, commands: [], refusal: "nothing corresponds" }));
  open("map:velocity");
  await userEvent.click(screen.getByRole("button", { name: "Fill what corresponds" }));
  expect(await screen.findByText(/Nothing was filled: nothing corresponds/)).toBeVisible();
  expect(server.params("edit")).toEqual([]);
});

it("adds a state to the machine, or to the state that is chosen", async () => {
  const box = node("m!Idle", [], { kind: "state", element: "robot.xmi#idle" });
  open("machine:ReceiveFSM", { element: "robot.xmi#machine", nodes: [box] });
  await userEvent.click(await screen.findByRole("button", { name: "states" }));
  expect(server.params("edit")[0]?.commands).toEqual([
    {
      kind: "add",
      owner: "robot.xmi#machine",
      feature: "states",
      type: "jaus.State",
      values: { name: ["State"] },
    },
  ]);
  update({ selection: [nodeKey("m!Idle")] });
  await waitFor(() => expect(server.params("form").at(-1)).toEqual({ element: "robot.xmi#idle" }));
  await userEvent.click(await screen.findByRole("button", { name: "states" }));
  await waitFor(() => expect(server.params("edit")).toHaveLength(2));
  expect(server.params("edit")[1]?.commands).toMatchObject([{ owner: "robot.xmi#idle" }]);
});

it("says that what is of the library is read-only, and that alone", () => {
  open("map:velocity", {}, true);
  expect(screen.getByText(/read-only/)).toBeVisible();
  expect(screen.queryByRole("button")).toBeNull();
});

it("has nothing to say of a system", () => {
  open("system");
  expect(document.querySelector(".view-bar")).toBeNull();
});
