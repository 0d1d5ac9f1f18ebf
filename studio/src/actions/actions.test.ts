import { describe, expect, test, vi } from "vitest";
import type { EditResult, Graph, Notifications } from "../protocol";
import { edgeKey, nodeKey, portKey } from "../selection";
import { state, update } from "../store";
import { PROJECT, serve } from "../testing/fakeServer";
import { edge, node, port, smallGraph } from "../testing/graphs";
import * as actions from "./index";

const VIEWS = [{ name: "system", kind: "system" as const, title: "", library: false }];
const DONE: EditResult = {
  revision: 2,
  created: [],
};

function serveGraph(graph: Graph = smallGraph(), revision = 1) {
  const server = serve({
    views: () => ({ views: VIEWS }),
    view: () => ({ revision, graph }),
    edit: () => DONE,
  });
  update({ graph, revision: 1, views: VIEWS });
  return server;
}

function changed(revision: number, more: Partial<Notifications["changed"]> = {}) {
  const log = { undoable: true, redoable: false };
  const params = { revision, files: PROJECT.files, by: "edit" as const, ...log, ...more };
  actions.listener.onNotification("changed", params);
}

test("a greeted page opens the file that was asked for, at its first view", async () => {
  const graph = smallGraph();
  serve({
    views: () => ({ views: VIEWS }),
    view: () => ({ revision: 3, graph }),
    problems: () => ({ revision: 3, elapsed_ms: 1, problems: [] }),
  });
  update({ file: "", view: "" });
  actions.listener.onLink("open", PROJECT, "");
  await vi.waitFor(() => expect(state().graph).toBe(graph));
  expect(state()).toMatchObject({ file: "robot.xmi", view: "system", revision: 3 });
});

test("a refused view says why", async () => {
  serve({
    view: () => {
      throw new Error("no layout");
    },
  });
  await actions.openView("system");
  expect(state()).toMatchObject({ graph: null, graphFault: "no layout" });
});

test("a view is followed when what it shows is renamed, and all is asked for", async () => {
  const [view, renamed] = ["service:Winch", "service:Hoist"].map((name) => [
    ...VIEWS,
    { name, kind: "service" as const, title: "", library: false },
  ]);
  const server = serve({
    views: () => ({ views: renamed! }),
    view: () => ({ revision: 2, graph: smallGraph() }),
  });
  update({ views: view!, view: "service:Winch", picture: 4, visits: 3 });
  await actions.refresh();
  expect(server.params("view")).toMatchObject([{ view: "service:Hoist", base: 0 }]);
  expect(state()).toMatchObject({ view: "service:Hoist", visits: 3 });
});

test("changes that come while the graph is loaded are answered by one more", async () => {
  const graph = smallGraph();
  const server = serveGraph(graph);
  changed(2);
  changed(3);
  changed(4);
  await vi.waitFor(() => expect(server.params("view")).toHaveLength(2));
  await actions.refresh();
  expect(server.params("view").length).toBeLessThanOrEqual(3);
});

test("the selection follows boxes and rows by name when ids shift", async () => {
  const before = smallGraph();
  serveGraph(before);
  actions.select([nodeKey("bridge"), portKey("base", "/odom")]);
  expect(state().chosen).toBe("robot.xmi#/odom");
  const after = smallGraph();
  after.nodes = after.nodes
    .filter((other) => other.id !== "ocu")
    .map((entry) => ({ ...entry, id: `new ${entry.id}`, element: `robot.xmi#new ${entry.id}` }));
  after.edges = [];
  serveGraph(after);
  update({ graph: before });
  await actions.refresh();
  expect(state().selection).toEqual([nodeKey("new bridge"), portKey("new base", "/odom")]);
});

test("what is gone is no longer chosen", async () => {
  serveGraph();
  actions.select([edgeKey("e1")]);
  const after = smallGraph();
  after.edges = [];
  serveGraph(after).answer("view", () => ({ revision: 2, graph: after }));
  update({ graph: smallGraph() });
  await actions.refresh();
  expect(state()).toMatchObject({ selection: [], chosen: "" });
});

test("an edit names the revision that it was thought of, and chooses what it made", async () => {
  const server = serveGraph();
  const after = smallGraph();
  after.nodes.push(node("fresh", []));
  server.answer("edit", () => ({ ...DONE, created: ["robot.xmi#fresh"] }));
  server.answer("view", () => ({ revision: 2, graph: after }));
  await actions.edit([{ kind: "remove", element: "x" }], "Try");
  expect(server.params("edit")[0]).toMatchObject({ base: 1, label: "Try" });
  expect(state().selection).toEqual([nodeKey("fresh")]);
  expect(state().said.text).toBe("Try");
});

test("who has chosen something else meanwhile stays there", async () => {
  const server = serveGraph();
  server.answer("edit", () => ({ ...DONE, created: ["robot.xmi#base"] }));
  const done = actions.edit([{ kind: "remove", element: "x" }], "Try");
  actions.select([nodeKey("ocu")]);
  await done;
  expect(state().chosen).toBe("robot.xmi#ocu");
});

test("ways to connect are asked for when the edits before are done", async () => {
  const server = serveGraph();
  let finish: (result: EditResult) => void = () => {};
  const answered = new Promise<EditResult>((resolve) => {
    finish = resolve;
  });
  server.answer("edit", () => answered as never);
  server.answer("connect", () => ({ options: [], refusal: "" }));
  const done = actions.edit([{ kind: "remove", element: "x" }], "Try");
  const end = { node: "ocu", port: "" };
  const offered = actions.connect(end, end);
  await Promise.resolve();
  expect(server.params("connect")).toEqual([]);
  finish(DONE);
  await Promise.all([done, offered]);
  expect(server.params("connect")).toHaveLength(1);
});

test("a refused edit is told, and changes nothing", async () => {
  const server = serveGraph();
  server.answer("edit", () => {
    throw new Error("it is of the library");
  });
  expect(await actions.edit([{ kind: "remove", element: "x" }], "Try")).toBeNull();
  expect(state().said).toMatchObject({ text: "it is of the library", isError: true });
});

test("delete asks first where others refer to it", async () => {
  const server = serveGraph();
  const referrers = [{ element: "robot.xmi#r", label: "bridge.velocity" }];
  server.answer("edit", ({ dry }) => (dry ? { ...DONE, referrers, diff: "-a" } : DONE));
  actions.select([nodeKey("ocu")]);
  const asked = actions.removeSelected();
  expect(state().dialog).toMatchObject({ kind: "delete", label: "Remove ocu", referrers: null });
  await asked;
  expect(state().dialog).toMatchObject({ kind: "delete", label: "Remove ocu", referrers });
  expect(server.params("edit").map((sent) => sent.dry)).toEqual([true]);
});

test("delete does it at once where nobody refers to it", async () => {
  const server = serveGraph();
  actions.select([portKey("ocu", "drive"), portKey("ocu", "pose")]);
  await actions.removeSelected();
  expect(state().dialog).toBeNull();
  expect(server.params("edit").at(-1)).toMatchObject({
    label: "Remove 2 elements",
    commands: [
      { kind: "remove", element: "robot.xmi#drive" },
      { kind: "remove", element: "robot.xmi#pose" },
    ],
  });
});

test("a box that is dropped stands where it was dropped, by one edit", async () => {
  const server = serveGraph();
  await actions.drop(ITEM, [10.4, 20.6]);
  const at = { file: "robot.xmi", view: "system", x: 10, y: 21 };
  expect(server.params("edit")).toMatchObject([{ commands: ITEM.commands, at }]);
});

test("what was copied is pasted into what is chosen", async () => {
  const server = serveGraph();
  server.answer("copy", () => ({ text: "bridge nav { }" }));
  const left_out = [{ name: "nav", message: "no vehicle" }];
  server.answer("paste", () => ({ ...DONE, left_out }));
  await actions.paste("");
  expect(state().said.text).toBe("Nothing was copied.");
  actions.select([nodeKey("bridge")]);
  // Tests of other files may leave a clipboard behind.
  vi.stubGlobal("navigator", {});
  await actions.copySelected();
  vi.unstubAllGlobals();
  expect(state().said.text).toBe("Copied bridge, for this page alone.");
  await actions.paste("");
  expect(server.params("paste")).toEqual([{ owner: "robot.xmi#bridge", text: "bridge nav { }" }]);
  expect(state().drafts).toMatchObject([{ field: "pasted", what: "nav: no vehicle" }]);
});

test("what was copied goes by the clipboard of the system where there is one", async () => {
  const server = serveGraph();
  const written: string[] = [];
  const writeText = async (text: string) => void written.push(text);
  vi.stubGlobal("navigator", { clipboard: { writeText } });
  server.answer("copy", () => ({ text: "bridge nav { }" }));
  server.answer("paste", () => ({ ...DONE, left_out: [] }));
  actions.select([nodeKey("bridge")]);
  await actions.copySelected();
  vi.unstubAllGlobals();
  expect([written, state().clip]).toEqual([["bridge nav { }"], ""]);
  await actions.paste("node other");
  expect(server.params("paste")).toMatchObject([{ text: "node other" }]);
});

test("where a line may end lights up until it is drawn, also if the answer comes late", async () => {
  const server = serveGraph();
  server.answer("ends", () => ({
    ends: [{ node: "base", port: "/odom", label: "", why: "" }],
  }));
  await actions.beginDrawing({ node: "ocu", port: "pose" });
  expect(state().legal).toEqual(new Set([portKey("base", "/odom")]));
  actions.endDrawing();
  const late = actions.beginDrawing({ node: "ocu", port: "pose" });
  actions.endDrawing();
  await late;
  expect(state().legal).toBeNull();
});

test("a search for ends is open at once, and once closed no late answer opens it again", async () => {
  const server = serveGraph();
  const ends = [{ node: "base", port: "/odom", label: "", why: "" }];
  server.answer("ends", () => ({ ends }));
  const offers = actions.offerEnds(nodeKey("ocu"));
  expect(state().dialog).toMatchObject({ kind: "ends", ends: null });
  await offers;
  expect(state().dialog).toMatchObject({ kind: "ends", ends });
  const late = actions.offerEnds(nodeKey("ocu"));
  update({ dialog: null });
  await late;
  expect(state().dialog).toBeNull();
});

test("what is no longer wanted when the answer comes neither opens nor is done", async () => {
  const server = serveGraph({ ...smallGraph(), edges: [edge("drive", ["ocu", ""], ["base", ""])] });
  const field = { feature: "name", values: ["operator"], changeable: true };
  server.answer("form", () => ({ readonly: false, fields: [field] }) as never);
  server.answer("connect", () => ({ options: [], refusal: "no" }));
  const help = { kind: "help" as const };
  const opened: [() => Promise<void>, object][] = [
    [actions.removeSelected, { kind: "delete", referrers: null }],
    [() => actions.beginRename(edgeKey("drive")), { kind: "rename", name: null }],
    [
      () => actions.connect({ node: "ocu", port: "" }, { node: "base", port: "" }),
      { kind: "connect", options: null },
    ],
  ];
  actions.select([nodeKey("ocu")]);
  for (const [begin, dialog] of opened) {
    for (const then of [null, help]) {
      const late = begin();
      expect(state().dialog).toMatchObject(dialog);
      update({ dialog: then });
      await late;
      expect(state().dialog).toEqual(then);
    }
  }
  expect(server.params("edit").filter((sent) => !sent.dry)).toEqual([]);
  const late = actions.beginRename(nodeKey("ocu"));
  expect(state().renaming).toMatchObject({ key: nodeKey("ocu"), name: null });
  update({ renaming: null });
  await late;
  expect(state().renaming).toBeNull();
});

test("renaming begins with the name of the model, not with what the box shows", async () => {
  const server = serveGraph();
  const field = { feature: "name", values: ["operator"], changeable: true };
  server.answer("form", () => ({ readonly: false, fields: [field] }) as never);
  actions.select([nodeKey("ocu")]);
  await actions.beginRename();
  expect(state().renaming).toMatchObject({ key: nodeKey("ocu"), name: "operator" });
  await actions.rename("robot.xmi#ocu", "operator", "driver");
  expect(server.params("edit").at(-1)?.commands).toEqual([
    { kind: "rename", element: "robot.xmi#ocu", name: "driver" },
  ]);
});

describe("what is renamed stays chosen, whoever asked for its new name", () => {
  const rename = { kind: "rename" as const, element: "robot.xmi#ocu", name: "driver" };

  /** A box that is chosen, and gets another name by the next edit. */
  function serveRenamed(id: string) {
    const graph = smallGraph();
    const server = serveGraph(graph);
    actions.select([nodeKey("ocu")]);
    const nodes = graph.nodes.map((entry) =>
      entry.id === "ocu" ? { ...entry, id, key: "key:driver", title: "driver" } : entry,
    );
    server.answer("view", () => ({ revision: 2, graph: { ...graph, nodes } }));
    return server;
  }

  test.each(["ocu", "driver"])("its box has the id %s then", async (id) => {
    serveRenamed(id).answer("edit", () => DONE);
    await actions.change([rename], "Rename");
    expect(state()).toMatchObject({ chosen: "robot.xmi#ocu", selection: [nodeKey(id)] });
  });

  test("as a row, whose box keeps its name", async () => {
    const graph = smallGraph();
    const server = serveGraph(graph);
    actions.select([portKey("base", "/odom")]);
    const nodes = graph.nodes.map((entry) => ({
      ...entry,
      ports: entry.ports.map((row) => (row.id === "/odom" ? { ...row, key: "key:pose" } : row)),
    }));
    server.answer("edit", () => DONE);
    server.answer("view", () => ({ revision: 2, graph: { ...graph, nodes } }));
    await actions.change([{ ...rename, element: "robot.xmi#/odom" }], "Rename");
    const selection = [portKey("base", "/odom")];
    expect(state()).toMatchObject({ chosen: "robot.xmi#/odom", selection });
  });

  test("from the first picture with the new name on, which comes before the answer", async () => {
    const server = serveRenamed("driver");
    let answer: (result: EditResult) => void = () => {};
    const answered = new Promise<EditResult>((resolve) => {
      answer = resolve;
    });
    server.answer("edit", () => answered as never);
    const done = actions.change([rename], "Rename");
    changed(2);
    await vi.waitFor(() => expect(state().revision).toBe(2));
    expect(state()).toMatchObject({ chosen: "robot.xmi#ocu", selection: [nodeKey("driver")] });
    answer({ ...DONE, created: [] });
    await done;
    expect(state().selection).toEqual([nodeKey("driver")]);
  });
});

test("a file that is gone makes room for another", async () => {
  serveGraph();
  const files = [{ ...PROJECT.files[0]!, path: "other.xmi" }];
  changed(2, { files, by: "outside" });
  await vi.waitFor(() => expect(state().file).toBe("other.xmi"));
  changed(3, { files: [], by: "outside" });
  await vi.waitFor(() => expect(state()).toMatchObject({ file: "", graph: null }));
});

test("verdicts are spoken when they change, and only then", () => {
  serveGraph();
  const problem = { severity: "error" } as never;
  const report = (problems: never[]) =>
    actions.listener.onNotification("problems", {
      revision: 1,
      elapsed_ms: 1,
      problems,
    });
  report([problem]);
  expect(state().said.text).toBe("1 error.");
  const { said } = state();
  report([problem]);
  expect(state().said).toBe(said);
  report([]);
  expect(state().said.text).toBe("No problems.");
});

test("a line that is no element is taken away as the server says", async () => {
  const server = serveGraph({
    ...smallGraph(),
    edges: [edge("S!inherits", ["vehicle", ""], ["bridge", ""], { element: "" })],
  });
  const command = { kind: "set" as const, element: "robot.xmi#S", feature: "inherits", values: [] };
  const option = { label: "S inherits nothing", why: "", preview: "", commands: [command] };
  server.answer("unlink", () => ({ options: [{ ...option, is_best: true }], refusal: "" }));
  actions.select([edgeKey("S!inherits")]);
  await actions.removeSelected();
  expect(server.params("unlink")[0]?.line).toBe("S!inherits");
  expect(server.params("edit")[0]?.commands).toEqual([command]);
  server.answer("unlink", () => ({ options: [], refusal: "it follows from its ends" }));
  actions.select([edgeKey("S!inherits")]);
  await actions.removeSelected();
  expect(state().said.text).toBe("it follows from its ends");
});

test("of selected uses of services each goes, and the services stay", async () => {
  const server = serveGraph();
  const rows = ["ocu!provides!S 1.0", "ocu!uses!T 1.0"];
  const graph = smallGraph();
  graph.nodes[0]!.ports = rows.map((row) => port(row, 30, { element: `robot.xmi#${row}` }));
  update({ graph });
  server.answer("unlink", ({ line }) => {
    const command = { kind: "set" as const, element: "robot.xmi#ocu", feature: line, values: [] };
    const option = { label: line, why: "", preview: "", commands: [command], is_best: true };
    return { options: [option], refusal: "" };
  });
  actions.select([portKey("ocu", rows[0]!), portKey("ocu", rows[1]!), nodeKey("base")]);
  await actions.removeSelected();
  expect(server.params("unlink").map(({ line }) => line)).toEqual(rows);
  const removed = server.params("edit").flatMap(({ commands }) => commands);
  expect(removed.filter(({ kind }) => kind === "remove")).toMatchObject([
    { element: "robot.xmi#base" },
    { element: "robot.xmi#base" },
  ]);
});

const ITEM = {
  id: "service Waypoints",
  group: "services" as const,
  label: "Waypoints",
  note: "",
  documentation: "",
  commands: [{ kind: "remove" as const, element: "of the system" }],
  label_of_edit: "add Waypoints",
  onto: "",
};

test("what is dropped on a box goes on it, as the server says", async () => {
  const server = serveGraph();
  const onBox = {
    ...ITEM,
    onto: "ocu",
    commands: [{ kind: "remove" as const, element: "on ocu" }],
  };
  server.answer("palette", ({ onto }) => ({ items: onto ? [onBox, ITEM] : [ITEM] }));
  await actions.drop(ITEM, null, "robot.xmi#ocu");
  expect(server.params("palette")[0]).toMatchObject({ query: "Waypoints", onto: "robot.xmi#ocu" });
  expect(server.params("edit").at(-1)?.commands).toEqual(onBox.commands);
  // What was offered for the choice goes into the system where it is dropped on nothing.
  await actions.drop(onBox);
  expect(server.params("edit").at(-1)?.commands).toEqual(ITEM.commands);
});

test("a box that is dragged into a host runs there, in one edit with its place", async () => {
  const server = serveGraph();
  const set = { kind: "set" as const, element: "p", feature: "components", values: ["ocu"] };
  const option = { label: "Run ocu on robot", why: "", preview: "", is_best: false };
  server.answer("host", () => ({ ...option, commands: [set] }));
  await actions.placeOn("robot", ["ocu"], { "key:ocu": [5, 6] });
  expect(server.params("host")[0]).toMatchObject({ nodes: ["ocu"], host: "robot" });
  const positions = { "key:ocu": [5, 6] };
  const placed = { kind: "place", file: "robot.xmi", view: "system", positions };
  expect(server.params("edit")).toMatchObject([
    { label: "Run ocu on robot", commands: [set, placed] },
  ]);
  // Where it runs already it is only moved.
  server.answer("host", () => ({ ...option, commands: [] }));
  await actions.placeOn("", ["ocu"], { "key:ocu": [5, 6] });
  expect(server.params("edit").at(-1)).toMatchObject({ label: "Move a box", commands: [placed] });
});

test("what is chosen while a cut is copied does not go", async () => {
  const server = serveGraph();
  const [one, other] = state().graph?.nodes ?? [];
  if (!one || !other) throw new Error("there are no two boxes");
  server.answer("copy", () => {
    actions.select([nodeKey(other.id)]);
    return { text: "copied" };
  });
  actions.select([nodeKey(one.id)]);
  await actions.cutSelected();
  expect(server.params("copy")).toEqual([{ elements: [one.element] }]);
  expect(server.params("edit")).toEqual([]);
  server.answer("copy", () => ({ text: "copied" }));
  await actions.cutSelected();
  expect(server.params("edit")[0]).toMatchObject({ commands: [{ element: other.element }] });
});
