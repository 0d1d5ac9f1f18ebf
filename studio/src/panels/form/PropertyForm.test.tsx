import { act, render, screen, waitFor, within } from "@testing-library/preact";
import userEvent from "@testing-library/user-event";
import { beforeEach, describe, expect, it } from "vitest";
import { choose } from "../../actions";
import { CallError } from "../../connection";
import { Banners } from "../../header/Banners";
import type { Form, FormField } from "../../protocol";
import { state, update } from "../../store";
import { type FakeServer, PROJECT, serve } from "../../testing/fakeServer";
import { PropertyForm } from "./PropertyForm";

const ELEMENT = "robot.xmi#drive";

function field(feature: string, more: Partial<FormField> = {}): FormField {
  return {
    feature,
    label: feature,
    kind: "text",
    many: false,
    required: false,
    values: [],
    shown: [],
    default: "",
    documentation: "",
    unit: "",
    choices: [],
    problems: [],
    changeable: true,
    group: "",
    ...more,
  };
}

const FIELDS = [
  field("name", { values: ["drive"], required: true }),
  field("rate", {
    kind: "number",
    unit: "Hz",
    documentation: "How often it is sent.",
    values: ["10"],
  }),
  field("isMandatory", { kind: "boolean", default: "true" }),
  field("reliability", {
    kind: "choice",
    default: "reliable",
    choices: [
      { value: "reliable", label: "reliable", documentation: "" },
      { value: "bestEffort", label: "best effort", documentation: "Lost is lost." },
    ],
  }),
  field("message", {
    kind: "reference",
    values: ["lib#a"],
    shown: ["SetWrenchEffort"],
    problems: ["the message is not provided"],
  }),
  field("topics", { many: true, values: ["a", "b", "c"] }),
];

const MESSAGES = [
  { value: "lib#a", label: "SetWrenchEffort", documentation: "" },
  { value: "lib#b", label: "ReportVelocityState", documentation: "" },
];

const FORM: Form = {
  element: ELEMENT,
  class: "bridge.Connection",
  title: "drive",
  documentation: "Carries one message.",
  readonly: false,
  owner: "robot.xmi#bridge",
  fields: FIELDS,
  children: [
    {
      feature: "joins",
      label: "joins",
      many: true,
      documentation: "",
      kinds: [
        {
          kind: "bridge.Join",
          label: "join",
          documentation: "",
          values: { name: ["join_2"], topic: ["join_2"] },
        },
      ],
      elements: [
        {
          element: "robot.xmi#join",
          label: "attitude",
          kind: "join",
          cells: [field("units", { values: ["rad"] })],
        },
        { element: "robot.xmi#other", label: "speed", kind: "join" },
      ],
    },
  ],
};

let server: FakeServer;

function show(form: Form = FORM) {
  server = serve({
    form: () => form,
    choices: ({ query }) => ({
      choices: MESSAGES.filter((message) => message.label.toLowerCase().includes(query)),
      more: 0,
    }),
    edit: ({ commands }) => ({
      revision: 1,
      created: commands[0]?.kind === "add" ? ["robot.xmi#new"] : [],
    }),
  });
  update({ chosen: ELEMENT });
  render(<PropertyForm />);
}

const commands = () => server.params("edit").flatMap((sent) => sent.commands);
const set = (feature: string, ...values: string[]) => ({
  kind: "set",
  element: ELEMENT,
  feature,
  values,
});

describe("the property form", () => {
  beforeEach(() => show());

  it("has fields that are about the same in groups", async () => {
    const fields = FIELDS.map((entry) =>
      entry.feature === "rate" ? { ...entry, group: "rates and limits" } : entry,
    );
    server.answer("form", () => ({ ...FORM, fields }));
    act(() => update({ project: { ...PROJECT, revision: 2 } }));
    const group = await screen.findByRole("group", { name: "rates and limits" });
    expect(within(group).getByLabelText("rate")).toBeVisible();
    expect(within(group).queryByLabelText("name")).toBeNull();
  });

  it("changes once, on Enter and not again when the focus goes", async () => {
    const rate = await screen.findByLabelText("rate");
    await userEvent.clear(rate);
    await userEvent.type(rate, "25{Enter}");
    await userEvent.tab();
    expect(commands()).toEqual([set("rate", "25")]);
  });

  it("changes when the focus goes", async () => {
    const rate = await screen.findByLabelText("rate");
    await userEvent.type(rate, "0");
    expect(commands()).toEqual([]);
    await userEvent.tab();
    expect(commands()).toEqual([set("rate", "100")]);
  });

  it("restores on Escape, and keeps the key to itself then", async () => {
    const rate = await screen.findByLabelText<HTMLInputElement>("rate");
    await userEvent.type(rate, "7{Escape}");
    expect(rate.value).toBe("10");
    await userEvent.tab();
    expect(commands()).toEqual([]);
  });

  it("keeps what is typed while the answer to the edit before comes", async () => {
    const rate = await screen.findByLabelText("rate");
    await userEvent.clear(rate);
    await userEvent.type(rate, "104{Enter}");
    await userEvent.clear(rate);
    await userEvent.type(rate, "105");
    const changed = (value: string) =>
      FIELDS.map((entry) => (entry.feature === "rate" ? { ...entry, values: [value] } : entry));
    server.answer("form", () => ({ ...FORM, fields: changed("104") }));
    act(() => update({ project: { ...PROJECT, revision: 2 } }));
    await waitFor(() => expect(server.params("form")).toHaveLength(2));
    expect(rate).toHaveValue("105");
    expect(screen.queryByText(/meanwhile/)).toBeNull();
    // Another page changes the field: what is typed here stays, and that is told.
    server.answer("form", () => ({ ...FORM, fields: changed("7") }));
    act(() => update({ project: { ...PROJECT, revision: 3 } }));
    expect(await screen.findByText("meanwhile it became 7")).toBeVisible();
    expect(rate).toHaveValue("105");
    await userEvent.type(rate, "{Enter}");
    expect(commands()).toEqual([set("rate", "104"), set("rate", "105")]);
  });

  it("keeps what is typed when the element has another ref, or cannot be asked for", async () => {
    const rate = await screen.findByLabelText("rate");
    await userEvent.type(rate, "5");
    server.answer("form", () => {
      throw new CallError(-32000, "not now");
    });
    act(() => update({ chosen: "robot.xmi#shifted" }));
    expect(await screen.findByText("not now")).toBeVisible();
    expect(screen.getByLabelText("rate")).toHaveValue("105");
    server.answer("form", () => ({ ...FORM, element: "robot.xmi#shifted" }));
    act(() => update({ project: { ...PROJECT, revision: 2 } }));
    await waitFor(() => expect(screen.queryByText("not now")).toBeNull());
    await userEvent.type(screen.getByLabelText("rate"), "{Enter}");
    expect(commands()).toEqual([{ ...set("rate", "105"), element: "robot.xmi#shifted" }]);
  });

  it("sends again what was refused", async () => {
    const rate = await screen.findByLabelText("rate");
    server.answer("edit", () => {
      throw new CallError(-32000, "the folder is read-only");
    });
    await userEvent.type(rate, "5{Enter}");
    expect(await screen.findByText(/read-only/)).toBeVisible();
    server.answer("edit", () => ({ revision: 1, created: [] }));
    await userEvent.type(rate, "{Enter}");
    expect(commands()).toEqual([set("rate", "105"), set("rate", "105")]);
  });

  it("shows what is there again when an edit is undone", async () => {
    const rate = await screen.findByLabelText("rate");
    await userEvent.type(rate, "5{Enter}");
    const changed = FIELDS.map((entry) =>
      entry.feature === "rate" ? { ...entry, values: ["105"] } : entry,
    );
    server.answer("form", () => ({ ...FORM, fields: changed }));
    act(() => update({ project: { ...PROJECT, revision: 2 } }));
    await waitFor(() => expect(server.params("form")).toHaveLength(2));
    await waitFor(() => expect(rate).toHaveValue("105"));
    server.answer("form", () => FORM);
    act(() => update({ project: { ...PROJECT, revision: 3 } }));
    await waitFor(() => expect(rate).toHaveValue("10"));
  });

  it("shows what is there where an edit was undone before it was seen", async () => {
    const rate = await screen.findByLabelText("rate");
    await userEvent.type(rate, "5{Enter}");
    expect(rate).toHaveValue("105");
    server.answer("form", () => structuredClone(FORM));
    act(() => update({ project: { ...PROJECT, revision: 3 } }));
    await waitFor(() => expect(rate).toHaveValue("10"));
  });

  it("keeps what is being typed while something else changes", async () => {
    const rate = await screen.findByLabelText("rate");
    await userEvent.type(rate, "5");
    server.answer("form", () => structuredClone(FORM));
    act(() => update({ project: { ...PROJECT, revision: 2 } }));
    await waitFor(() => expect(server.params("form")).toHaveLength(2));
    await userEvent.type(rate, "6{Enter}");
    expect(commands()).toEqual([set("rate", "1056")]);
  });

  it("keeps a wrong number while another element is shown, and has it in its field again", async () => {
    render(<Banners />);
    const rate = await screen.findByLabelText("rate");
    await userEvent.clear(rate);
    await userEvent.type(rate, "1o");
    act(() => choose("robot.xmi#other"));
    const kept = await screen.findByText(/Typed, and not taken: rate of drive: “1o”. .*no number/);
    act(() => choose(ELEMENT));
    await waitFor(() => expect(screen.getByLabelText("rate")).toHaveValue("1o"));
    await waitFor(() => expect(kept).not.toBeInTheDocument());
    expect(await screen.findByText("'1o' is no number")).toBeVisible();
    act(() => choose("robot.xmi#other"));
    await userEvent.click(await screen.findByRole("button", { name: "Discard" }));
    expect(state().drafts).toEqual([]);
    expect(commands()).toEqual([]);
  });

  it("keeps what the server refuses when another element is shown by then", async () => {
    let refuse: (error: Error) => void = () => {};
    server.answer("edit", () => new Promise((_, no) => (refuse = no)) as never);
    const rate = await screen.findByLabelText("rate");
    await userEvent.clear(rate);
    await userEvent.type(rate, "20{Enter}");
    act(() => choose("robot.xmi#other"));
    expect(state().drafts).toEqual([]);
    act(() => refuse(new Error("the disk is full")));
    await waitFor(() =>
      expect(state().drafts).toMatchObject([{ text: "20", why: "the disk is full" }]),
    );
  });

  it("tells a wrong number where it is, and sends nothing", async () => {
    const rate = await screen.findByLabelText("rate");
    await userEvent.clear(rate);
    await userEvent.type(rate, "fast{Enter}");
    expect(screen.getByText("'fast' is no number")).toBeVisible();
    expect(rate).toHaveAttribute("aria-invalid", "true");
    expect(commands()).toEqual([]);
  });

  it("tells where it is what the server refuses", async () => {
    server.answer("edit", () => {
      throw new CallError(-32000, "a rate is more than 0");
    });
    const rate = await screen.findByLabelText("rate");
    await userEvent.type(rate, "{Control>}a{/Control}0{Enter}");
    expect(await screen.findByText("a rate is more than 0")).toBeVisible();
  });

  it("unsets what is emptied, but not what must have a value", async () => {
    await userEvent.clear(await screen.findByLabelText("rate"));
    await userEvent.tab();
    expect(commands()).toEqual([set("rate")]);
    await userEvent.clear(screen.getByLabelText("name"));
    await userEvent.tab();
    expect(screen.getByText("name must have a value")).toBeVisible();
    expect(commands()).toHaveLength(1);
  });

  it("renames by the command that takes references along", async () => {
    const name = await screen.findByLabelText("name");
    await userEvent.type(name, "_2{Enter}");
    expect(commands()).toEqual([{ kind: "rename", element: ELEMENT, name: "drive_2" }]);
  });

  it("sets truths and choices at once", async () => {
    await userEvent.click(await screen.findByLabelText("isMandatory"));
    await userEvent.selectOptions(screen.getByLabelText("reliability"), "best effort");
    expect(commands()).toEqual([set("isMandatory", "false"), set("reliability", "bestEffort")]);
  });

  it("shows a truth as the model has it whenever its change is refused", async () => {
    server.answer("edit", () => {
      throw new CallError(-32000, "the folder is read-only");
    });
    const isMandatory = await screen.findByLabelText("isMandatory");
    for (const times of [1, 2]) {
      await userEvent.click(isMandatory);
      await waitFor(() => expect(commands()).toHaveLength(times));
      await waitFor(() => expect(isMandatory).toBeChecked());
    }
  });

  it("finds references as one types, by keyboard alone", async () => {
    const message = await screen.findByRole("combobox", { name: "message" });
    expect(message).toHaveValue("SetWrenchEffort");
    expect(server.params("choices")).toEqual([]);
    await userEvent.type(message, "veloc{Enter}");
    await waitFor(() => expect(commands()).toEqual([set("message", "lib#b")]));
    expect(server.params("choices").at(-1)).toMatchObject({ feature: "message", query: "veloc" });
  });

  it("shows what is wrong beside the field, and describes the field with it", async () => {
    const message = await screen.findByRole("combobox", { name: "message" });
    expect(message).toHaveAccessibleDescription(/the message is not provided/);
  });

  it("tells what a field means on request, by keyboard too", async () => {
    const help = await screen.findByRole("button", { name: "What is rate?" });
    expect(screen.getByText("How often it is sent.")).not.toBeVisible();
    help.focus();
    await userEvent.keyboard("{Enter}");
    expect(screen.getByText("How often it is sent.")).toBeVisible();
    expect(screen.getByText("Hz")).toBeVisible();
  });

  it("adds, removes and reorders values of lists", async () => {
    const list = await screen.findByRole("list", { name: "topics" });
    await userEvent.click(within(list).getByRole("button", { name: "Move b up" }));
    await userEvent.click(within(list).getByRole("button", { name: "Remove b" }));
    await userEvent.type(within(list).getByLabelText("Add to topics"), "d{Enter}");
    expect(commands()).toEqual([
      set("topics", "b", "a", "c"),
      set("topics", "a", "c"),
      set("topics", "a", "b", "c", "d"),
    ]);
  });

  it("adds children with what they begin with, moves them, and goes to them", async () => {
    await userEvent.click(await screen.findByRole("button", { name: "Move speed up" }));
    await userEvent.click(screen.getByRole("button", { name: "Add join" }));
    expect(commands()).toEqual([
      { kind: "move", element: "robot.xmi#other", owner: ELEMENT, feature: "joins", position: 0 },
      {
        kind: "add",
        owner: ELEMENT,
        feature: "joins",
        type: "bridge.Join",
        values: { name: ["join_2"], topic: ["join_2"] },
      },
    ]);
    expect(state().chosen).toBe("robot.xmi#new");
    await userEvent.click(await screen.findByRole("button", { name: "attitude join" }));
    expect(state().chosen).toBe("robot.xmi#join");
  });

  it("adds one child after the other by name, and changes them where they are listed", async () => {
    const name = await screen.findByLabelText("Name to add to joins");
    await userEvent.type(name, "one{Enter}two{Enter}");
    expect(name).toHaveFocus();
    await waitFor(() => expect(commands()).toHaveLength(2));
    const added = { kind: "add", owner: ELEMENT, feature: "joins", type: "bridge.Join" };
    expect(commands()).toEqual([
      { ...added, values: { name: ["one"], topic: ["one"] } },
      { ...added, values: { name: ["two"], topic: ["two"] } },
    ]);
    expect(state().chosen).toBe(ELEMENT);
    const units = screen.getByLabelText("units of attitude");
    await userEvent.clear(units);
    await userEvent.type(units, "deg{Enter}");
    const set = { kind: "set", element: "robot.xmi#join", feature: "units", values: ["deg"] };
    expect(commands().at(-1)).toEqual(set);
    expect(server.params("edit").at(-1)?.label).toBe("Set units of attitude");
  });

  it("deletes children as the diagram does, which asks where others refer to them", async () => {
    await userEvent.click(await screen.findByRole("button", { name: "Remove speed" }));
    expect(server.params("edit")[0]).toMatchObject({ dry: true });
  });
});

it("changes nothing of the library", async () => {
  show({ ...FORM, readonly: true });
  const rate = await screen.findByLabelText("rate");
  expect(rate).toHaveAttribute("readonly");
  expect(screen.queryByRole("button", { name: "Add join" })).toBeNull();
  expect(screen.queryByRole("button", { name: "Remove b" })).toBeNull();
});

it("shows hostile text as text", async () => {
  const hostile = "<script>alert(1)</script><img src=x onerror=alert(1)>";
  show({
    ...FORM,
    title: hostile,
    documentation: hostile,
    fields: [field("note", { values: [hostile], documentation: hostile, problems: [hostile] })],
  });
  expect(await screen.findByDisplayValue(hostile)).toBeVisible();
  expect(document.querySelector("script, img")).toBeNull();
});

it("asks for a choice while nothing is chosen", () => {
  serve();
  render(<PropertyForm />);
  expect(screen.getByText(/Choose something/)).toBeVisible();
});
