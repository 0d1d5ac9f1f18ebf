import { EditorView } from "@codemirror/view";
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { CallError } from "../../connection";
import { merged } from "./merging";
import { fromOutside, IN_STEP, type SyncState, TextSync } from "./textSync";

/** A file that others write too. */
class SharedFile {
  text: string;
  revision = 1;
  written: string[] = [];

  constructor(text: string) {
    this.text = text;
  }

  async read() {
    return { text: this.text, revision: this.revision, editable: true };
  }

  async write(text: string, base: number) {
    if (base !== this.revision) throw new CallError(-32000, "it was changed", true);
    this.text = text;
    this.revision += 1;
    this.written.push(text);
    return { revision: this.revision };
  }

  change(text: string) {
    this.text = text;
    this.revision += 1;
  }
}

let file: SharedFile;
let view: EditorView;
let sync: TextSync;
let state: SyncState;

function begin(text: string) {
  file = new SharedFile(text);
  view = new EditorView({
    doc: text,
    extensions: EditorView.updateListener.of((update) => {
      const isOwn = update.transactions.some((transaction) => !transaction.annotation(fromOutside));
      if (update.docChanged && isOwn) sync.touched();
    }),
  });
  state = IN_STEP;
  sync = new TextSync(view, file, { text, revision: 1, editable: true }, (message) => {
    state = message;
  });
}

function type(at: number, insert: string) {
  view.dispatch({ changes: { from: at, insert }, selection: { anchor: at + insert.length } });
}

const shown = () => view.state.doc.toString();

beforeEach(() => {
  vi.useFakeTimers();
});
afterEach(() => {
  vi.useRealTimers();
  view?.destroy();
});

describe("text and file", () => {
  it("writes after a pause, once for all that was typed", async () => {
    begin("abc\n");
    type(0, "x");
    await vi.advanceTimersByTimeAsync(300);
    type(1, "y");
    await vi.advanceTimersByTimeAsync(300);
    expect(file.written).toEqual([]);
    expect(state.isUnsaved).toBe(true);
    await vi.advanceTimersByTimeAsync(200);
    expect(file.written).toEqual(["xyabc\n"]);
    expect(state.isUnsaved).toBe(false);
  });

  it("takes in what others write, without moving the cursor", async () => {
    begin("first\nsecond\nthird\n");
    view.dispatch({ selection: { anchor: 8 } });
    file.change("zeroth\nfirst\nsecond\nlast\n");
    await sync.pull();
    expect(shown()).toBe("zeroth\nfirst\nsecond\nlast\n");
    expect(view.state.selection.main.head).toBe(15);
    await vi.advanceTimersByTimeAsync(1000);
    expect(file.written).toEqual([]);
  });

  it("keeps both changes at different places", async () => {
    begin("first\nsecond\nthird\n");
    type(0, "own ");
    file.change("first\nsecond\nTHIRD\n");
    await vi.advanceTimersByTimeAsync(1500);
    expect(shown()).toBe("own first\nsecond\nTHIRD\n");
    expect(file.text).toBe("own first\nsecond\nTHIRD\n");
    expect(state.theirs).toBeNull();
  });

  it("shows what both changed at one place, and writes nothing till it is decided", async () => {
    begin("rate: 10\n");
    type(6, "9");
    file.change("rate: 20\n");
    await vi.advanceTimersByTimeAsync(1500);
    expect(state.theirs).toBe("rate: 20\n");
    expect(shown()).toBe("rate: 910\n");
    expect(file.text).toBe("rate: 20\n");
    await sync.keepOwn();
    expect(file.text).toBe("rate: 910\n");
    expect(state).toEqual(IN_STEP);
  });

  it("gives way where that is what was decided", async () => {
    begin("rate: 10\n");
    type(6, "9");
    file.change("rate: 20\n");
    await sync.pull();
    sync.takeTheirs();
    expect(shown()).toBe("rate: 20\n");
    await vi.advanceTimersByTimeAsync(1000);
    expect(file.written).toEqual([]);
    expect(state).toEqual(IN_STEP);
  });

  it("says why it could not write, and tries again with what is typed next", async () => {
    begin("abc\n");
    const write = file.write.bind(file);
    file.write = () => Promise.reject(new CallError(-32000, "the disk is full"));
    type(0, "x");
    await vi.advanceTimersByTimeAsync(500);
    expect(state).toMatchObject({ isUnsaved: true, error: "the disk is full" });
    file.write = write;
    type(0, "y");
    await vi.advanceTimersByTimeAsync(500);
    expect(file.text).toBe("yxabc\n");
    expect(state).toEqual(IN_STEP);
  });

  it("tries again when the file can be read again", async () => {
    begin("abc\n");
    const write = file.write.bind(file);
    file.write = () => Promise.reject(new CallError(-1, "There is no connection."));
    type(0, "x");
    await vi.advanceTimersByTimeAsync(500);
    file.write = write;
    await sync.pull();
    await vi.advanceTimersByTimeAsync(500);
    expect(file.text).toBe("xabc\n");
    expect(state).toEqual(IN_STEP);
  });

  it("gives lines the ends that they had", async () => {
    begin("a\r\nb\r\n");
    expect(shown()).toBe("a\nb\n");
    type(1, "x");
    await vi.advanceTimersByTimeAsync(500);
    expect(file.text).toBe("ax\r\nb\r\n");
  });

  it("writes what is left when the editor closes", async () => {
    begin("abc\n");
    type(0, "x");
    await sync.close();
    expect(file.text).toBe("xabc\n");
  });
});

describe("merging", () => {
  it("needs nothing where both did the same", () => {
    expect(merged("a", "b", "b")).toEqual([]);
  });

  it("refuses insertions at one place", () => {
    expect(merged("ab", "a1b", "a2b")).toBeNull();
  });
});
