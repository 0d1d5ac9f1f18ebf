import { act, fireEvent, render, screen, waitFor, within } from "@testing-library/preact";
import userEvent from "@testing-library/user-event";
import { beforeEach, expect, test } from "vitest";
import { select } from "../actions";
import { edgeKey, groupKey, nodeKey, portKey } from "../selection";
import { state, update } from "../store";
import { type FakeServer, serve } from "../testing/fakeServer";
import { smallGraph } from "../testing/graphs";
import { Canvas } from "./Canvas";
import { domId } from "./marks";

let server: FakeServer;

beforeEach(() => {
  const graph = smallGraph();
  server = serve({
    views: () => ({ views: [] }),
    view: () => ({ revision: 2, graph }),
    edit: () => ({ revision: 1, created: [] }),
  });
  update({ graph, revision: 1 });
});

const diagram = () => screen.getByRole("application", { name: "Diagram of robot" });
const box = (name: string) => screen.getByRole("group", { name: new RegExp(name) });
const part = (key: string) => document.getElementById(domId(key));

async function press(keys: string) {
  act(() => diagram().focus());
  await userEvent.keyboard(keys);
}

test("boxes have names, rows and what is wrong with them, as words too", () => {
  const graph = smallGraph();
  graph.nodes[0]!.findings = [{ severity: "error", message: "has no address" }];
  update({ graph });
  render(<Canvas />);
  const ocu = box("component ocu, 2 rows, error: has no address");
  expect(within(ocu).getByRole("img", { name: "error" })).toHaveTextContent("×");
  expect(within(ocu).getByRole("group", { name: "drive" })).toBeVisible();
  expect(box("node base")).toBeVisible();
});

test("model text is text", () => {
  const graph = smallGraph();
  graph.title = "robot";
  graph.nodes[0]!.title = "<script>alert(1)</script>";
  graph.nodes[0]!.ports[0]!.label = '"><img src=x onerror=alert(1)>';
  update({ graph });
  render(<Canvas />);
  expect(document.querySelector("script, img")).toBeNull();
  expect(screen.getByText("<script>alert(1)</script>")).toBeVisible();
});

test("the diagram is one tab stop", async () => {
  render(<Canvas />);
  const stops = [...document.querySelectorAll<HTMLElement>(".flow, .flow *")].filter(
    (element) => element.tabIndex === 0 && element.tagName !== "A",
  );
  expect(stops).toEqual([diagram()]);
});

test("arrows go about, and the diagram names where the keyboard stands", async () => {
  render(<Canvas />);
  await press("{ArrowDown}");
  expect(diagram()).toHaveAttribute("aria-activedescendant", domId(nodeKey("ocu")));
  await press("{ArrowDown}{ArrowRight}");
  expect(state().selection).toEqual([edgeKey("e1")]);
  await press("{ArrowRight}");
  expect(state().selection).toEqual([portKey("bridge", "velocity")]);
  expect(part(portKey("bridge", "velocity"))).toHaveClass("chosen", "active");
  await press("{Shift>}{ArrowUp}{/Shift}");
  expect(state().selection).toEqual([portKey("bridge", "velocity"), nodeKey("bridge")]);
  await press("{Control>}a{/Control}");
  expect(state().selection).toHaveLength(3);
  await press("{Escape}");
  expect(state().selection).toEqual([]);
});

test("a click on a row chooses the row", () => {
  render(<Canvas />);
  fireEvent.click(screen.getByRole("group", { name: "/odom" }));
  expect(state()).toMatchObject({
    selection: [portKey("base", "/odom")],
    chosen: "robot.xmi#/odom",
  });
});

test("Alt and arrows move boxes; what is moved in a row is one edit", async () => {
  render(<Canvas />);
  act(() => select([nodeKey("bridge")]));
  await press("{Alt>}{ArrowRight}{ArrowDown}{Shift>}{ArrowDown}{/Shift}{/Alt}");
  await waitFor(() => expect(server.params("edit")).toHaveLength(1));
  expect(server.params("edit")[0]?.commands).toMatchObject([
    { kind: "place", positions: { "key:bridge": [230, 60] } },
  ]);
});

test("what was moved by keys stays moved in its view, also where another one is opened at once", async () => {
  render(<Canvas />);
  act(() => select([nodeKey("bridge")]));
  await press("{Alt>}{ArrowRight}{/Alt}");
  act(() => update({ view: "map:velocity" }));
  await waitFor(() => expect(server.params("edit")).toHaveLength(1));
  expect(server.params("edit")[0]?.commands).toMatchObject([{ kind: "place", view: "system" }]);
});

test("F2 renames in place, Escape leaves it, Enter keeps it", async () => {
  const field = { feature: "name", values: ["ocu"], changeable: true };
  server.answer("form", () => ({ readonly: false, fields: [field] }) as never);
  render(<Canvas />);
  act(() => select([nodeKey("ocu")]));
  await press("{F2}");
  const input = await screen.findByLabelText("New name");
  expect(input).toHaveFocus();
  await userEvent.keyboard("{Escape}");
  expect(screen.queryByLabelText("New name")).toBeNull();
  expect(server.params("edit")).toEqual([]);
  expect(diagram()).toHaveFocus();
  await press("{F2}");
  await screen.findByLabelText("New name");
  // Neither letters nor Delete reach the diagram meanwhile.
  await userEvent.keyboard("dr{Delete}{Enter}");
  await waitFor(() => expect(server.params("edit")).toHaveLength(1));
  expect(server.params("edit")[0]?.commands).toEqual([
    { kind: "rename", element: "robot.xmi#ocu", name: "dr" },
  ]);
  await waitFor(() => expect(diagram()).toHaveFocus());
});

test("a label stands at the side of its room where its line is", () => {
  const graph = smallGraph();
  const route: [number, number][] = [
    [0, 0],
    [9, 0],
    [9, 9],
    [0, 9],
  ];
  Object.assign(graph.edges[0]!, { route, label: [20, 5], anchor: "start", labels: ["controls"] });
  update({ graph });
  render(<Canvas />);
  const text = part(edgeKey("e1"))!.querySelector("text")!;
  expect(text).toHaveAttribute("text-anchor", "start");
  expect(text.querySelector("tspan")).toHaveAttribute("x", "20");
});

test("what is watched stands out by shape and word, not by colour alone", () => {
  update({
    live: {
      edges: {
        e1: { level: "ok", text: "25.0 of 25 Hz of the sensor" },
        e2: { level: "error", text: "failing: no peer" },
        e3: { level: "not heard", text: "silent" },
      },
      boxes: { base: { level: "stale", text: "nothing heard" } },
    } as never,
  });
  render(<Canvas />);
  expect(part(edgeKey("e1"))).toHaveClass("live-ok");
  expect(part(edgeKey("e1"))).toHaveTextContent("✓ 25.0 of 25 Hz");
  expect(part(edgeKey("e2"))).toHaveClass("live-failing");
  expect(part(edgeKey("e3"))).toHaveClass("live-silent");
  // Layouts make room for so much; the rest is told on request.
  const [said] = part(edgeKey("e1"))!.querySelectorAll("tspan");
  expect(said).toHaveTextContent("✓ 25.0 of 25 Hz of the …");
  expect(part(nodeKey("base"))).toHaveClass("live-silent");
  expect(part(nodeKey("base"))).toHaveTextContent("? nothing heard");
});

test("a filter fades what does not fit, and Enter goes from one to the next", async () => {
  render(<Canvas />);
  const field = screen.getByLabelText("Filter by name");
  await userEvent.type(field, "odom");
  expect(part(nodeKey("ocu"))).toHaveClass("dim");
  expect(part(nodeKey("base"))).not.toHaveClass("dim");
  await userEvent.keyboard("{Enter}{Enter}");
  expect(state().selection).toEqual([portKey("base", "/odom")]);
  await userEvent.keyboard("{Escape}");
  expect(part(nodeKey("ocu"))).not.toHaveClass("dim");
  expect(diagram()).toHaveFocus();
});

test("an item of the palette that is dropped is added", async () => {
  render(<Canvas />);
  const item = { commands: [{ kind: "remove", element: "x" }], label_of_edit: "Add it" };
  fireEvent.drop(diagram(), { dataTransfer: { getData: () => JSON.stringify(item) } });
  await waitFor(() => expect(server.params("edit")).toHaveLength(1));
  expect(server.params("edit")[0]).toMatchObject({ label: "Add it" });
});

test("a row of a bridge that is dropped on another one is carried by that", async () => {
  const graph = smallGraph();
  const main = graph.nodes[1]!;
  graph.nodes.push({ ...main, id: "other", element: "robot.xmi#other", title: "other", ports: [] });
  update({ graph });
  const commands = [{ kind: "remove" as const, element: "x" }];
  server.answer("carry", () => ({
    ...{ label: "Move velocity to other", why: "", preview: "", commands, is_best: false },
  }));
  render(<Canvas />);
  const kept = new Map<string, string>();
  const dataTransfer = {
    effectAllowed: "",
    setData: (type: string, text: string) => kept.set(type, text),
    getData: (type: string) => kept.get(type) ?? "",
  };
  const row = part(portKey("bridge", "velocity"))!;
  expect(row).toHaveAttribute("draggable", "true");
  fireEvent.dragStart(row, { dataTransfer });
  fireEvent.drop(part(nodeKey("other"))!, { dataTransfer });
  await waitFor(() => expect(server.params("edit")).toHaveLength(1));
  const element = main.ports.find((port) => port.id === "velocity")!.element;
  expect(server.params("carry")[0]).toMatchObject({
    elements: [element],
    bridge: "robot.xmi#other",
  });
});

test("a bridge tells its load", async () => {
  server.answer("loads", () => ({ loads: { bridge: "0.95 % CPU" } }));
  render(<Canvas />);
  expect(await screen.findByText("0.95 % CPU")).toBeInTheDocument();
});

test("an empty folder offers a new model, an empty diagram says what to do", async () => {
  const { rerender } = render(<Canvas />);
  act(() => update({ graph: { ...smallGraph(), nodes: [], edges: [] } }));
  expect(screen.getByText("This diagram is empty.")).toBeVisible();
  const project = { ...state().project!, files: [] };
  act(() => update({ graph: null, file: "", view: "", project }));
  rerender(<Canvas />);
  server.answer("starting_points", () => ({ points: [] }));
  await userEvent.click(screen.getByRole("button", { name: "New model…" }));
  expect(state().dialog).toMatchObject({ kind: "create" });
});

test("a box gets another host by keys, and frames are gone to from inside", async () => {
  const graph = smallGraph();
  const rest = { element: "", parent: "", x: 0, y: 0, width: 9, height: 9 };
  graph.groups = [
    { ...rest, id: "h", key: "h", kind: "host", title: "host robot" },
    { ...rest, id: "f", key: "f", kind: "bridge", title: "bridge", parent: "h" },
  ];
  graph.nodes[1]!.group = "f";
  update({ graph });
  render(<Canvas />);
  select([portKey("bridge", "velocity")]);
  await press("f");
  expect(state().selection).toEqual([groupKey("f")]);
  await press("f");
  expect(state().selection).toEqual([groupKey("h")]);
  await press("h");
  expect(state().dialog).toEqual({ kind: "hosts", boxes: ["bridge"] });
});

test("an initial state has its dot, and says so", () => {
  const graph = smallGraph();
  graph.nodes[0]!.initial = true;
  update({ graph });
  render(<Canvas />);
  expect(box("component ocu.*, the initial state")).toHaveClass("initial");
});

test("the bodies of messages of a service are asked for, and left out again", async () => {
  update({ graph: { ...smallGraph(), view: "service:Winch" } });
  render(<Canvas />);
  const bodies = () => screen.getByRole("button", { name: "Bodies" });
  expect(bodies()).toHaveAttribute("aria-pressed", "false");
  await userEvent.click(bodies());
  expect(state().view).toBe("bodies:Winch");
  act(() => update({ graph: { ...smallGraph(), view: "bodies:Winch" } }));
  expect(bodies()).toHaveAttribute("aria-pressed", "true");
  await userEvent.click(bodies());
  expect(state().view).toBe("service:Winch");
});

test("the map of a large diagram can be hidden", async () => {
  const graph = smallGraph();
  const more = Array.from({ length: 9 }, (_, at) => ({ ...graph.nodes[0]!, id: `more${at}` }));
  update({ graph: { ...graph, nodes: [...graph.nodes, ...more], width: 9000, height: 9000 } });
  render(<Canvas />);
  const map = () => document.querySelector(".react-flow__minimap");
  expect(map()).not.toBeNull();
  await userEvent.click(screen.getByRole("button", { name: "Map" }));
  expect(map()).toBeNull();
});
