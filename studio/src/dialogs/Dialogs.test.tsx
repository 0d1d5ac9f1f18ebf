import { render, screen, waitFor } from "@testing-library/preact";
import userEvent from "@testing-library/user-event";
import { beforeEach, expect, test } from "vitest";
import { onShortcut } from "../keyboard/shortcuts";
import type { ConnectOption } from "../protocol";
import { state, update } from "../store";
import { type FakeServer, serve } from "../testing/fakeServer";
import { smallGraph } from "../testing/graphs";
import { Dialogs } from "./Dialogs";

let server: FakeServer;

beforeEach(() => {
  const graph = smallGraph();
  server = serve({
    views: () => ({ views: [{ name: "system", kind: "system", title: "", library: false }] }),
    view: () => ({ revision: 1, graph }),
    edit: ({ label, dry }) => ({
      revision: 1,
      created: [],
      ...(dry && { diff: `+connect ${label}` }),
    }),
  });
  update({ graph, revision: 1 });
});

function option(label: string, is_best = false): ConnectOption {
  const commands = [{ kind: "remove" as const, element: label }];
  return { label, why: `why ${label}`, preview: "", commands, is_best };
}

test("the ways to connect come with reasons, the best one first; Enter takes it", async () => {
  const ends = { source: { node: "a", port: "" }, target: { node: "b", port: "" } };
  const options = [option("new map"), option("ready map", true)];
  update({ dialog: { kind: "connect", ...ends, options, refusal: "" } });
  render(<Dialogs />);
  const shown = screen.getAllByRole("option");
  expect(shown[0]).toHaveTextContent("ready map fits best");
  expect(shown[0]).toHaveTextContent("why ready map");
  expect(await screen.findByText("+connect ready map")).toBeVisible();
  await userEvent.keyboard("{ArrowDown}");
  expect(await screen.findByText("+connect new map")).toBeVisible();
  await userEvent.keyboard("{ArrowUp}{Enter}");
  const done = () => server.params("edit").filter((sent) => !sent.dry);
  await waitFor(() => expect(done()).toHaveLength(1));
  expect(done()[0]).toMatchObject({ label: "ready map" });
  expect(state().dialog).toBeNull();
});

test("what cannot be connected is told with the reason", async () => {
  const ends = { source: { node: "a", port: "" }, target: { node: "b", port: "" } };
  update({ dialog: { kind: "connect", ...ends, options: [], refusal: "both only take" } });
  render(<Dialogs />);
  expect(screen.getByRole("alert")).toHaveTextContent("both only take");
  await userEvent.click(screen.getByRole("button", { name: "Understood" }));
  expect(state().dialog).toBeNull();
});

test("the ends that are allowed are searched as one types", async () => {
  const ends = [
    { node: "base", port: "/odom", label: "base /odom", why: "odometry" },
    { node: "base", port: "/pose", label: "base /pose", why: "a pose" },
  ];
  server.answer("connect", () => ({ options: [option("x")], refusal: "" }));
  update({ dialog: { kind: "ends", from: { node: "ocu", port: "pose" }, ends } });
  render(<Dialogs />);
  await userEvent.keyboard("POSE a{Enter}");
  await waitFor(() => expect(server.params("connect")).toHaveLength(1));
  expect(server.params("connect")[0]).toMatchObject({ target: { node: "base", port: "/pose" } });
});

test("what is typed while the ends are looked for is not lost, and Enter waits for them", async () => {
  const dialog = { kind: "ends" as const, from: { node: "ocu", port: "pose" }, ends: null };
  server.answer("connect", () => ({ options: [option("x")], refusal: "" }));
  update({ dialog });
  render(<Dialogs />);
  await userEvent.keyboard("POSE a{Enter}");
  expect(screen.getByText("Looking…")).toBeVisible();
  expect(server.params("connect")).toHaveLength(0);
  const ends = [
    { node: "base", port: "/odom", label: "base /odom", why: "odometry" },
    { node: "base", port: "/pose", label: "base /pose", why: "a pose" },
  ];
  update({ dialog: { ...dialog, ends } });
  await waitFor(() => expect(server.params("connect")).toHaveLength(1));
  expect(server.params("connect")[0]).toMatchObject({ target: { node: "base", port: "/pose" } });
});

test("deleting shows who refers to it, and does it when told so", async () => {
  const commands = [{ kind: "remove" as const, element: "robot.xmi#ocu" }];
  const referrers = [{ element: "robot.xmi#velocity", label: "bridge velocity" }];
  const more = { label: "Remove ocu", referrers, diff: "-a", base: 7 };
  const dialog = { kind: "delete" as const, commands, ...more };
  update({ dialog });
  const { unmount } = render(<Dialogs />);
  await userEvent.click(screen.getByRole("button", { name: "bridge velocity" }));
  expect(state()).toMatchObject({ dialog: null, chosen: "robot.xmi#velocity" });
  unmount();
  update({ dialog });
  render(<Dialogs />);
  await userEvent.click(screen.getByRole("button", { name: "Delete" }));
  expect(server.params("edit")[0]).toMatchObject({ commands, label: "Remove ocu", base: 7 });
});

test("Escape closes, and the focus goes back", async () => {
  const view = render(
    <>
      <button type="button">before</button>
      <Dialogs />
    </>,
  );
  screen.getByText("before").focus();
  update({ dialog: { kind: "help" } });
  view.rerender(
    <>
      <button type="button">before</button>
      <Dialogs />
    </>,
  );
  expect(screen.getByRole("dialog", { name: "Keys" })).toBeVisible();
  await userEvent.click(screen.getByRole("button", { name: "Close" }));
  await waitFor(() => expect(screen.queryByRole("dialog")).toBeNull());
  expect(screen.getByText("before")).toHaveFocus();
});

const POINTS = [
  { name: "empty", kind: "plain" as const, about: "nothing" },
  { name: "iop-ugv", kind: "profile" as const, about: "a ground vehicle" },
];

test("a new model is created in either notation, under a name that is free", async () => {
  server.answer("create", () => ({ revision: 2, created: [] }));
  update({ dialog: { kind: "create", points: POINTS } });
  render(<Dialogs />);
  const name = screen.getByLabelText("Name");
  await userEvent.click(screen.getByLabelText(/XMI/));
  expect(screen.getByRole("alert")).toHaveTextContent("There is a robot.xmi already.");
  await userEvent.clear(name);
  await userEvent.type(name, "rover{Enter}");
  await waitFor(() => expect(server.params("create")).toHaveLength(1));
  expect(server.params("create")).toEqual([{ file: "rover.xmi", origin: "empty" }]);
});

test("a model begins with what was chosen, which may be text alone", async () => {
  server.answer("create", () => ({ revision: 2, created: [] }));
  update({ dialog: { kind: "create", points: POINTS } });
  render(<Dialogs />);
  await userEvent.click(screen.getByLabelText(/XMI/));
  const from = screen.getByRole("combobox", { name: "Begin with" });
  await userEvent.selectOptions(from, "iop-ugv");
  expect(from).toHaveAccessibleDescription(/A ground vehicle\. What only a person can decide/);
  expect(screen.getByLabelText(/XMI/)).toBeDisabled();
  await userEvent.click(screen.getByRole("button", { name: "Create robot.ros2jaus" }));
  expect(server.params("create")).toEqual([{ file: "robot.ros2jaus", origin: "iop-ugv" }]);
});

test("keys of the page undo and redo, but not while somebody types or a dialog is open", async () => {
  server.answer("undo", () => ({ revision: 1, entry: null }));
  server.answer("redo", () => ({ revision: 1, entry: null }));
  document.addEventListener("keydown", onShortcut);
  render(
    <>
      <input aria-label="field" />
      <Dialogs />
    </>,
  );
  await userEvent.keyboard("{Control>}z{/Control}{Control>}{Shift>}z{/Shift}{/Control}");
  await userEvent.keyboard("{Control>}y{/Control}");
  expect(server.asked.map((request) => request.method)).toEqual(["undo", "redo", "redo"]);
  await userEvent.type(screen.getByLabelText("field"), "{Control>}z{/Control}?");
  expect(server.asked).toHaveLength(3);
  expect(state().dialog).toBeNull();
  document.removeEventListener("keydown", onShortcut);
});

test("hosts are chosen among those of the diagram", async () => {
  const rest = { element: "", parent: "", x: 0, y: 0, width: 9, height: 9, kind: "host" };
  const groups = ["desk", "robot"].map((id) => ({ ...rest, id, key: id, title: `host ${id}` }));
  update({ graph: { ...smallGraph(), groups }, dialog: { kind: "hosts", boxes: ["ocu"] } });
  const none = { label: "Run ocu on robot", why: "", preview: "", commands: [], is_best: false };
  server.answer("host", () => none);
  render(<Dialogs />);
  await userEvent.keyboard("rob{Enter}");
  await waitFor(() => expect(server.params("host")).toHaveLength(1));
  expect(server.params("host")[0]).toMatchObject({ nodes: ["ocu"], host: "robot" });
});
