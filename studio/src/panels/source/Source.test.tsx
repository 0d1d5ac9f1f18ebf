import { cleanup, render, screen, waitFor } from "@testing-library/preact";
import userEvent from "@testing-library/user-event";
import { beforeEach, expect, it, vi } from "vitest";
import { state, update } from "../../store";
import { PROJECT, serve } from "../../testing/fakeServer";
import { Source } from "./Source";

const TEXT = "// why\nsystem robot {\n    bridge main {}\n}\n";
const PROJECT_OF_TEXT = {
  ...PROJECT,
  files: [{ path: "robot.ros2jaus", notation: "text" as const, stale: false, dirty: false }],
  opened: "robot.ros2jaus",
};

class SilentSocket {
  send() {}
  close() {}
}

beforeEach(() => {
  vi.stubGlobal("WebSocket", SilentSocket);
  return () => vi.unstubAllGlobals();
});

function show(text: string, editable: boolean) {
  const start = text.indexOf("bridge");
  const server = serve(
    {
      text: () => ({ text, revision: 1, editable }),
      source: ({ element }) => ({
        file: "robot.ros2jaus",
        notation: "text",
        start,
        end: start + "bridge main {}".length,
        line: 3,
        revision: 1,
        element,
      }),
      write: () => ({ revision: 2 }),
      undo: () => ({ revision: 2, entry: null }),
      at: () => ({ element: "robot.ros2jaus#//@bridges.0" }),
    },
    PROJECT_OF_TEXT,
  );
  render(<Source />);
  return server;
}

async function content(): Promise<HTMLElement> {
  return waitFor(
    () => {
      const line = document.querySelector(".editor-host")?.shadowRoot?.querySelector(".cm-content");
      if (!line) throw new Error("no editor yet");
      return line as HTMLElement;
    },
    { timeout: 10_000 },
  );
}

it("shows the text in a root of its own, and the span of what is chosen", async () => {
  show(TEXT, true);
  const editor = await content();
  expect(editor.textContent).toContain("bridge main {}");
  expect(document.head.querySelector("style")).toBeNull();
  update({ chosen: "robot.ros2jaus#//@bridges.0" });
  await waitFor(() => {
    const marks = [...editor.querySelectorAll(".cm-chosen")].map((element) => element.textContent);
    expect(marks.join("")).toBe("bridge main {}");
  });
});

it("writes what is typed before it undoes, by the one history of the project", async () => {
  const server = show(TEXT, true);
  const editor = await content();
  editor.focus();
  const { EditorView } = await import("@codemirror/view");
  const view = EditorView.findFromDOM(editor);
  view?.dispatch({ changes: { from: 0, insert: "x" }, userEvent: "input.type" });
  await userEvent.keyboard("{Control>}z{/Control}");
  await waitFor(() => expect(server.params("undo")).toHaveLength(1));
  const methods = server.asked.map((request) => request.method);
  expect(methods.indexOf("write")).toBeLessThan(methods.indexOf("undo"));
  expect(server.params("write")[0]).toMatchObject({
    file: "robot.ros2jaus",
    text: `x${TEXT}`,
    base: 1,
  });
});

it("keeps what was typed and is not in the file, until it is decided what holds", async () => {
  const server = show(TEXT, true);
  server.answer("write", () => {
    throw new Error("the disk is full");
  });
  const { EditorView } = await import("@codemirror/view");
  const view = EditorView.findFromDOM(await content());
  view?.dispatch({ changes: { from: 0, insert: "x" }, userEvent: "input.type" });
  cleanup();
  await waitFor(() => expect(state().drafts).toMatchObject([{ text: `x${TEXT}` }]));
  server.answer("write", () => ({ revision: 2 }));
  render(<Source />);
  expect(await screen.findByText("Keep what is here")).toBeVisible();
  expect((await content()).textContent).toContain("x// why");
  expect(state().drafts).toEqual([]);
  await userEvent.click(screen.getByText("Keep what is here"));
  await waitFor(() => expect(server.params("write").at(-1)).toMatchObject({ text: `x${TEXT}` }));
});

it("chooses the element where the cursor is set", async () => {
  show(TEXT, true);
  const editor = await content();
  const { EditorView } = await import("@codemirror/view");
  EditorView.findFromDOM(editor)?.dispatch({
    selection: { anchor: 30 },
    userEvent: "select.pointer",
  });
  await waitFor(() => expect(state().chosen).toBe("robot.ros2jaus#//@bridges.0"));
});

it("lets nobody type where the file is not to be edited", async () => {
  show(TEXT, false);
  expect(await content()).toHaveAttribute("aria-label", "Text of the file, read-only");
});

it("says when lines end in different ways, which no editor gives back", async () => {
  show("a\r\nb\n", true);
  expect(await screen.findByText(/end in different ways/)).toBeVisible();
  expect(await content()).toHaveAttribute("aria-label", "Text of the file, read-only");
});
