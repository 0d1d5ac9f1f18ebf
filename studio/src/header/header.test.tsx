import { act, render, screen, waitFor, within } from "@testing-library/preact";
import userEvent from "@testing-library/user-event";
import { beforeEach, expect, test } from "vitest";
import { listener } from "../actions";
import type { ViewInfo } from "../protocol";
import { state, update } from "../store";
import { type FakeServer, PROJECT, serve } from "../testing/fakeServer";
import { smallGraph } from "../testing/graphs";
import { Banners } from "./Banners";
import { Header } from "./Header";

let server: FakeServer;

beforeEach(() => {
  server = serve({
    view: () => ({ revision: 1, graph: smallGraph() }),
    undo: () => ({ revision: 1, entry: null }),
  });
});

test("views of the file come before those of the library, each with its kind", async () => {
  const view = (name: string, kind: ViewInfo["kind"], library = false) => ({
    name,
    kind,
    title: name.split(":")[1] ?? "",
    library,
  });
  update({
    views: [
      view("system", "system"),
      view("map:pose", "map"),
      view("service:T", "service", true),
      view("machine:M", "machine", true),
      view("service:S", "service", true),
    ],
  });
  render(<Header />);
  const names = screen.getAllByRole("option").map((element) => element.textContent);
  expect(names).toEqual(["robot.xmi", "System", "Map: pose", "S", "T", "M"]);
  const services = screen.getByRole("group", { name: "Library: services" });
  expect(within(services).getAllByRole("option")).toHaveLength(2);
  expect(screen.getByRole("group", { name: "Library: state machines" })).toBeVisible();
  await userEvent.selectOptions(screen.getByLabelText("View"), "map:pose");
  expect(server.params("view")).toMatchObject([{ file: "robot.xmi", view: "map:pose" }]);
  await userEvent.click(screen.getByRole("button", { name: "Undo" }));
  expect(state().said.text).toBe("There is nothing to undo.");
});

test("a lost or refused connection is told at once", () => {
  render(<Banners />);
  act(() => listener.onLink("lost", null, ""));
  expect(screen.getByRole("alert")).toHaveTextContent("connection to the server is lost");
  act(() => listener.onLink("refused", null, "the token is another one"));
  expect(screen.getByRole("alert")).toHaveTextContent("the token is another one");
});

test("a stale file is told as long as it is stale", () => {
  render(<Banners />);
  expect(screen.queryByRole("status")).toBeNull();
  const files = [{ ...PROJECT.files[0]!, stale: true }];
  act(() => update({ project: { ...PROJECT, files } }));
  expect(screen.getByRole("status")).toHaveTextContent("robot.xmi cannot be read as it is now");
});

test("what another program did is shown; a conflict stays until it is dismissed", async () => {
  render(<Banners />);
  const gone = false;
  const conflict = { file: "robot.xmi", diff: "-mine\n+theirs", gone };
  act(() => listener.onNotification("conflict", conflict));
  act(() => listener.onNotification("outside", { file: "robot.xmi", diff: "+more", gone }));
  act(() => listener.onNotification("outside", { file: "maps.xmi", diff: "", gone }));
  expect(screen.getAllByRole("status").map((element) => element.textContent?.[0])).toEqual([
    "×",
    "i",
  ]);
  await userEvent.click(screen.getByRole("button", { name: "Show the difference" }));
  expect(state().dialog).toMatchObject({ kind: "diff", diff: "-mine\n+theirs" });
  await userEvent.click(screen.getAllByRole("button", { name: "Dismiss" })[0]!);
  expect(screen.getAllByRole("status")).toHaveLength(1);
});

test("many changes are one note, and a file that is gone is told as that", async () => {
  render(<Banners />);
  const note = (file: string, gone: boolean) =>
    act(() => listener.onNotification("outside", { file, diff: `+${file}\n`, gone }));
  for (const file of ["a", "b", "c", "d", "e"]) note(`${file}.xmi`, false);
  expect(screen.getByRole("status")).toHaveTextContent("changed a.xmi, b.xmi, c.xmi and 2 more");
  await userEvent.click(screen.getByRole("button", { name: "Show the difference" }));
  expect(state().dialog).toMatchObject({ diff: "+a.xmi\n+b.xmi\n+c.xmi\n+d.xmi\n+e.xmi\n" });
  await userEvent.click(screen.getByRole("button", { name: "Dismiss" }));
  note("a.xmi", true);
  expect(screen.getByRole("status")).toHaveTextContent("deleted a.xmi; undo brings it back");
});

test("undo and redo are grey while there is nothing for them", () => {
  render(<Header />);
  const undo = screen.getByRole("button", { name: "Undo" });
  expect(undo).toHaveAttribute("aria-disabled", "false");
  act(() => update({ project: { ...PROJECT, undoable: false } }));
  expect(undo).toHaveAttribute("aria-disabled", "true");
});

test("an edit that was not done stays with its values until somebody decides", async () => {
  const edit = {
    number: 4,
    label: "Set address of winch",
    commands: [
      { kind: "set" as const, element: "robot.xmi#w", feature: "address", values: ["1.1.77"] },
    ],
    why: "address of winch was changed meanwhile, to 1.1.55",
    files: ["robot.xmi"],
  };
  server.answer("kept.again", () => ({ revision: 1, created: [] }));
  server.answer("kept.discard", () => ({}));
  render(<Banners />);
  act(() => listener.onNotification("kept", { edits: [edit] }));
  const status = screen.getByRole("status");
  expect(status).toHaveTextContent("Set address of winch");
  expect(status).toHaveTextContent("address: 1.1.77");
  expect(status).toHaveTextContent("to 1.1.55");
  await userEvent.click(screen.getByRole("button", { name: "Do it all the same" }));
  await userEvent.click(screen.getByRole("button", { name: "Discard" }));
  expect(server.params("kept.again")).toEqual([{ number: 4 }]);
  expect(server.params("kept.discard")).toEqual([{ number: 4 }]);
  act(() => listener.onNotification("kept", { edits: [] }));
  expect(screen.queryByRole("status")).toBeNull();
});

test("an edit that was kept is told although the server that kept it has ended", async () => {
  server.answer("kept", () => ({ edits: [] }));
  render(<Banners />);
  const command = { kind: "set" as const, element: "r#a", feature: "rate", values: ["25"] };
  const edit = { number: 4, label: "Set rate", commands: [command], why: "changed", files: ["r"] };
  act(() => listener.onNotification("kept", { edits: [edit] }));
  act(() => listener.onLink("open", PROJECT, ""));
  await waitFor(() => expect(state().kept).toEqual([]));
  const banner = screen.getByText(/Typed, and not taken: Set rate: “25”. The server .* ended/);
  await userEvent.click(within(banner).getByRole("button", { name: "Discard" }));
  expect(state().drafts).toEqual([]);
});

test("a picture that is not of the files as they are says so", () => {
  render(<Banners />);
  const why = "robot.xmi cannot be read as it is: mend it first";
  act(() => update({ freshness: { state: "unreadable", since: 3, why } }));
  expect(screen.getByRole("status")).toHaveTextContent(why);
  expect(screen.getByRole("status")).toHaveTextContent("revision 3");
  act(() => update({ freshness: { state: "unreadable", since: 0, why } }));
  expect(screen.getByRole("status")).toHaveTextContent("how it was before (revision 0)");
  act(() => update({ freshness: { state: "unreadable", since: null, why } }));
  expect(screen.getByRole("status")).toHaveTextContent("shows nothing for certain");
  act(() => update({ freshness: { state: "current", since: 4, why: "" } }));
  expect(screen.queryByRole("status")).toBeNull();
});
