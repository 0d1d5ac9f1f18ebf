import { beforeEach, expect, test, vi } from "vitest";
import { listener } from "./actions";
import { addressOf, keepAddress, takeAddress } from "./address";
import { nodeKey } from "./selection";
import { BEGINNING, state, update } from "./store";
import { PROJECT, serve } from "./testing/fakeServer";
import { smallGraph } from "./testing/graphs";

beforeEach(() => {
  sessionStorage.clear();
  update(BEGINNING);
});

test("a reload shows the same file, view, part and choice", async () => {
  const files = ["robot.xmi", "other & more.xmi"].map((path) => ({ ...PROJECT.files[0]!, path }));
  const project = { ...PROJECT, files };
  const views = ["system", "map:a b"].map((name) => ({
    name,
    kind: "map" as const,
    title: "",
    library: false,
  }));
  const problems = { revision: 1, elapsed_ms: 1, problems: [] };
  serve(
    {
      views: () => ({ views }),
      view: () => ({ revision: 1, graph: smallGraph() }),
      problems: () => problems,
      kept: () => ({ edits: [] }),
    },
    project,
  );
  const shown = {
    file: "other & more.xmi",
    view: "map:a b",
    chosen: "robot.xmi#ocu",
    sight: [-20, 7.25, 1.5] as [number, number, number],
  };
  update(shown);
  const address = addressOf();
  update(BEGINNING);
  takeAddress(`#token=abc&${address}`, sessionStorage);
  listener.onLink("open", project, "");
  await vi.waitFor(() => expect(state().graph).not.toBeNull());
  expect(state()).toMatchObject({ ...shown, selection: [nodeKey("ocu")] });
});

test("what was typed and is not taken is kept for after a reload", () => {
  const draft = {
    element: "robot.xmi#ocu",
    field: "documentation 0",
    what: "",
    text: "a",
    why: "",
  };
  keepAddress(window, sessionStorage);
  update({ file: "robot.xmi", drafts: [draft] });
  window.dispatchEvent(new Event("pagehide"));
  expect(window.location.hash).toBe("#file=robot.xmi");
  const kept = sessionStorage.getItem("jausml-drafts") ?? "";
  update(BEGINNING);
  sessionStorage.setItem("jausml-drafts", kept);
  takeAddress("#sight=1+2+nonsense", sessionStorage);
  expect(state()).toMatchObject({ drafts: [draft], sight: null });
  sessionStorage.setItem("jausml-drafts", "{");
  takeAddress("", sessionStorage);
  expect(state().drafts).toEqual([]);
});
