import { act, createEvent, fireEvent, render, screen, within } from "@testing-library/preact";
import userEvent from "@testing-library/user-event";
import { beforeEach, expect, it } from "vitest";
import { DRAGGED } from "../../actions";
import type { PaletteItem } from "../../protocol";
import { update } from "../../store";
import { type FakeServer, serve } from "../../testing/fakeServer";
import { Palette } from "./Palette";

function item(id: string, group: PaletteItem["group"], label: string): PaletteItem {
  return {
    id,
    group,
    label,
    note: `note of ${label}`,
    documentation: `What ${label} is.`,
    commands: [{ kind: "remove", element: id }],
    label_of_edit: `Add ${label}`,
    onto: "",
  };
}

const ITEMS = [
  item("1", "services", "PrimitiveDriver"),
  item("2", "elements", "bridge"),
  item("3", "services", "VelocityStateSensor"),
];

let server: FakeServer;

beforeEach(() => {
  localStorage.clear();
  server = serve({
    palette: ({ query }) => ({
      items: ITEMS.filter((other) => other.label.toLowerCase().includes(query.toLowerCase())),
    }),
    edit: () => ({ revision: 1, created: [] }),
  });
});

const added = () => server.params("edit").map((sent) => sent.label);
const names = () => screen.getAllByRole("option").map((element) => element.textContent ?? "");

it("shows what can be added by group, with what it is", async () => {
  render(<Palette />);
  await screen.findByRole("option", { name: /PrimitiveDriver/ });
  expect(screen.getByText("elements")).toBeVisible();
  expect(screen.getByText("services")).toBeVisible();
  expect(names()[0]).toContain("note of bridge");
  expect(screen.getByText("What bridge is.")).toBeVisible();
});

it("keeps what is typed before there is a view, and forgets it with the view", async () => {
  update({ file: "robot.ros2jaus", view: "" });
  render(<Palette />);
  const search = screen.getByRole("combobox");
  await userEvent.type(search, "velo");
  act(() => update({ view: "system" }));
  expect(search).toHaveValue("velo");
  act(() => update({ view: "service:Winch" }));
  expect(search).toHaveValue("");
});

it("searches while one types, and adds the chosen one on Enter", async () => {
  render(<Palette />);
  const search = screen.getByRole("combobox");
  await userEvent.type(search, "velo");
  await screen.findByRole("option", { name: /VelocityStateSensor/, selected: true });
  await userEvent.keyboard("{Enter}");
  expect(added()).toEqual(["Add VelocityStateSensor"]);
});

it("moves by arrows, and names the active one to screen readers", async () => {
  render(<Palette />);
  await screen.findByRole("option", { name: /PrimitiveDriver/ });
  await userEvent.type(screen.getByRole("combobox"), "{ArrowDown}{ArrowDown}");
  const chosen = screen.getByRole("option", { selected: true });
  expect(chosen).toHaveTextContent("VelocityStateSensor");
  expect(screen.getByRole("combobox")).toHaveAttribute("aria-activedescendant", chosen.id);
});

it("remembers what was used, and asks anew for its commands", async () => {
  const { unmount } = render(<Palette />);
  await userEvent.dblClick(await screen.findByRole("option", { name: /PrimitiveDriver/ }));
  expect(added()).toEqual(["Add PrimitiveDriver"]);
  unmount();

  render(<Palette />);
  const list = screen.getByRole("listbox");
  await within(list).findByText("recently used");
  await userEvent.type(screen.getByRole("combobox"), "{Enter}");
  expect(server.params("palette").at(-1)?.query).toBe("PrimitiveDriver");
  expect(added()).toEqual(["Add PrimitiveDriver", "Add PrimitiveDriver"]);
});

it("gives the diagram what is dragged", async () => {
  render(<Palette />);
  const row = await screen.findByRole("option", { name: /PrimitiveDriver/ });
  const data = new Map<string, string>();
  const event = createEvent.dragStart(row);
  Object.defineProperty(event, "dataTransfer", {
    value: { setData: (type: string, text: string) => data.set(type, text) },
  });
  fireEvent(row, event);
  expect(JSON.parse(data.get(DRAGGED) ?? "{}")).toEqual(ITEMS[0]);
});

it("tells what the server refuses", async () => {
  server.answer("edit", () => {
    throw new Error("the library is not changed");
  });
  render(<Palette />);
  await userEvent.dblClick(await screen.findByRole("option", { name: /bridge/ }));
  expect(await screen.findByRole("alert")).toHaveTextContent("the library is not changed");
});

it("shows what fits the chosen element first, and says on what it goes", async () => {
  const fits = { ...item("4", "services", "Waypoints"), onto: "vehicle" };
  server.answer("palette", ({ onto }) => ({ items: onto ? [fits, ...ITEMS] : ITEMS }));
  render(<Palette />);
  await screen.findByRole("option", { name: /PrimitiveDriver/ });
  act(() => update({ chosen: "robot.xmi#vehicle" }));
  expect(await screen.findByText("services on vehicle")).toBeVisible();
  expect(names()[0]).toContain("Waypoints");
  expect(server.params("palette").at(-1)?.onto).toBe("robot.xmi#vehicle");
});
