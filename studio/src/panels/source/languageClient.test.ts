import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { type Diagnostic, fileOf, fileUri, LanguageClient } from "./languageClient";

interface Message {
  id?: number;
  method?: string;
  params?: Record<string, unknown>;
  result?: unknown;
}

/** The other end of a socket. */
class FakeSocket {
  onopen: (() => void) | null = null;
  onmessage: ((event: { data: string }) => void) | null = null;
  onclose: ((event: { code: number }) => void) | null = null;
  readonly sent: Message[] = [];

  constructor() {
    sockets.push(this);
  }

  send(text: string) {
    this.sent.push(JSON.parse(text) as Message);
  }

  close() {
    this.onclose?.({ code: 1006 });
  }

  tell(message: Message) {
    this.onmessage?.({ data: JSON.stringify({ jsonrpc: "2.0", ...message }) });
  }

  /** Answers the last request, and lets the client take it. */
  async answer(result: unknown) {
    const last = this.sent.findLast(
      (message) => message.id !== undefined && message.method !== undefined,
    );
    this.tell({ ...(last?.id === undefined ? {} : { id: last.id }), result });
    await vi.waitFor(() => undefined);
    for (let turn = 0; turn < 5; turn++) await Promise.resolve();
  }

  get methods() {
    return this.sent.map((message) => message.method);
  }
}

const URI = "file:///robot/maps.ros2jaus";
let sockets: FakeSocket[];
let client: LanguageClient;

async function greeted(socket = sockets.at(-1)): Promise<FakeSocket> {
  if (!socket) throw new Error("no socket");
  socket.onopen?.();
  await socket.answer({});
  await socket.answer({ capabilities: {} });
  return socket;
}

beforeEach(() => {
  sockets = [];
  vi.stubGlobal("WebSocket", FakeSocket);
  client = new LanguageClient("ws://localhost/language", "secret", "file:///robot/");
});
afterEach(() => vi.unstubAllGlobals());

describe("the client of the language server", () => {
  it("shows its token first, then what it can, then its text", async () => {
    client.openText(URI, "a", () => undefined);
    const socket = await greeted();
    expect(socket.methods).toEqual(["hello", "initialize", "initialized", "textDocument/didOpen"]);
    expect(socket.sent[0]?.params).toEqual({ token: "secret" });
  });

  it("tells changes once, with rising versions", async () => {
    const socket = await greeted();
    client.openText(URI, "a", () => undefined);
    client.changeText("ab");
    client.changeText("ab");
    client.changeText("abc");
    const changes = socket.sent.filter((message) => message.method === "textDocument/didChange");
    expect(changes.map((change) => change.params?.textDocument)).toEqual([
      { uri: URI, version: 2 },
      { uri: URI, version: 3 },
    ]);
  });

  it("takes what is wrong with its text, and not what is wrong with others", async () => {
    const shown: Diagnostic[][] = [];
    const socket = await greeted();
    client.openText(URI, "a", (diagnostics) => shown.push(diagnostics));
    const wrong = {
      range: { start: { line: 0, character: 0 }, end: { line: 0, character: 1 } },
      message: "no",
    };
    const method = "textDocument/publishDiagnostics";
    socket.tell({ method, params: { uri: "file:///other", diagnostics: [wrong] } });
    socket.tell({ method, params: { uri: URI, diagnostics: [wrong] } });
    expect(shown).toEqual([[wrong]]);
  });

  it("asks about a place, and answers what it is asked with nothing", async () => {
    const socket = await greeted();
    client.openText(URI, "a", () => undefined);
    const items = client.complete({ line: 0, character: 1 });
    await socket.answer({ isIncomplete: false, items: [{ label: "scale" }] });
    expect(await items).toEqual([{ label: "scale" }]);
    socket.tell({ id: 77, method: "workspace/configuration", params: {} });
    expect(socket.sent.at(-1)).toMatchObject({ id: 77, result: null });
  });

  it("comes back with its text when the connection is lost", async () => {
    vi.useFakeTimers();
    try {
      const first = await greeted();
      client.openText(URI, "a", () => undefined);
      client.changeText("ab");
      const waiting = client.hover({ line: 0, character: 0 });
      first.close();
      await expect(waiting).rejects.toThrow("lost");
      await vi.advanceTimersByTimeAsync(600);
      const second = await greeted();
      expect(second).not.toBe(first);
      expect(second.sent.at(-1)?.params?.textDocument).toMatchObject({ text: "ab" });
    } finally {
      vi.useRealTimers();
    }
  });

  it("knows nothing while there is no connection", async () => {
    client.openText(URI, "a", () => undefined);
    expect(await client.complete({ line: 0, character: 0 })).toEqual([]);
    expect(await client.hover({ line: 0, character: 0 })).toBeNull();
  });
});

describe("addresses of files", () => {
  it("goes both ways, with what addresses escape", () => {
    const uri = fileUri("/home/a b", "models/é#1.ros2jaus");
    expect(uri).toBe("file:///home/a%20b/models/%C3%A9%231.ros2jaus");
    expect(fileOf("/home/a b", uri)).toBe("models/é#1.ros2jaus");
    expect(fileOf("/home/other", uri)).toBeNull();
  });

  it("knows drives", () => {
    const uri = fileUri("C:\\robots", "a.ros2jaus");
    expect(uri).toBe("file:///C:/robots/a.ros2jaus");
    expect(fileOf("C:\\robots", uri)).toBe("a.ros2jaus");
  });
});
