import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { CallError, Connection, type Link, RIGHT_KEY, takeToken } from "./connection";
import { PROJECT } from "./testing/fakeServer";

// The other side of a socket, in the hand of the test.
class Wire {
  static made: Wire[] = [];
  onopen: (() => void) | null = null;
  onmessage: ((event: { data: string }) => void) | null = null;
  onclose: ((event: { code: number }) => void) | null = null;
  sent: { id: number; method: string; params: unknown }[] = [];

  constructor(readonly address: string) {
    Wire.made.push(this);
  }

  send(text: string) {
    this.sent.push(JSON.parse(text));
  }

  close() {
    this.onclose?.({ code: 1000 });
  }

  tell(message: object) {
    this.onmessage?.({ data: JSON.stringify({ jsonrpc: "2.0", ...message }) });
  }
}

const links: [Link, string][] = [];
const notified: unknown[] = [];

function open(): { connection: Connection; wire: Wire } {
  const connection = new Connection("ws://localhost/socket", "secret", {
    onLink: (link, _project, reason) => links.push([link, reason]),
    onNotification: (name, params) => notified.push([name, params]),
  });
  connection.open();
  const wire = Wire.made.at(-1)!;
  wire.onopen?.();
  return { connection, wire };
}

beforeEach(() => {
  vi.useFakeTimers();
  vi.stubGlobal("WebSocket", Wire);
  Wire.made = [];
  links.length = notified.length = 0;
});
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

test("it says who it is first, and is open when the server knows it", async () => {
  const { connection, wire } = open();
  expect(wire.sent).toEqual([
    { jsonrpc: "2.0", id: 0, method: "hello", params: { token: "secret" } },
  ]);
  await expect(connection.call("undo", {})).rejects.toThrow("no connection");
  wire.tell({ id: 0, result: PROJECT });
  await vi.waitFor(() => expect(links).toEqual([["open", ""]]));
});

test("answers find their questions, in any order", async () => {
  const { connection, wire } = open();
  wire.tell({ id: 0, result: PROJECT });
  await vi.waitFor(() => expect(links).toHaveLength(1));
  const [first, second] = [connection.call("undo", {}), connection.call("redo", {})];
  wire.tell({ id: 2, result: { revision: 2 } });
  wire.tell({ id: 1, error: { code: -1, message: "not now", data: { conflict: true } } });
  await expect(second).resolves.toEqual({ revision: 2 });
  const fault = await first.catch((error: unknown) => error);
  expect(fault).toBeInstanceOf(CallError);
  expect(fault).toMatchObject({ message: "not now", conflict: true });
  wire.tell({ method: "live", params: { state: {} } });
  expect(notified).toEqual([["live", { state: {} }]]);
});

test("a lost connection is told to whoever waits, and opened again", async () => {
  const { connection, wire } = open();
  wire.tell({ id: 0, result: PROJECT });
  await vi.waitFor(() => expect(links).toHaveLength(1));
  const waiting = connection.call("undo", {}).catch((error: Error) => error.message);
  wire.onclose?.({ code: 1006 });
  await expect(waiting).resolves.toMatch("lost");
  expect(links.at(-1)).toEqual(["lost", ""]);
  await vi.advanceTimersByTimeAsync(300);
  expect(Wire.made).toHaveLength(2);
  Wire.made[1]?.onclose?.({ code: 1006 });
  await vi.advanceTimersByTimeAsync(599);
  expect(Wire.made).toHaveLength(2);
  await vi.advanceTimersByTimeAsync(1);
  expect(Wire.made).toHaveLength(3);
});

test("who is not known is told so, and does not try again", async () => {
  const { wire } = open();
  wire.tell({ id: 0, error: { code: 401, message: "the token is another one" } });
  await vi.waitFor(() => expect(links).toEqual([["refused", "the token is another one"]]));
  await vi.advanceTimersByTimeAsync(60_000);
  expect(Wire.made).toHaveLength(1);
});

test("the right to command leaves the address too, and goes with an address without it", () => {
  const take = () => takeToken(window.location, window.history, window.sessionStorage);
  window.location.hash = "#token=abc&command=xyz";
  expect(take()).toBe("abc");
  expect(window.location.href).not.toContain("xyz");
  expect(window.sessionStorage.getItem(RIGHT_KEY)).toBe("xyz");
  window.location.hash = "#token=abc";
  expect(take()).toBe("abc");
  expect(window.sessionStorage.getItem(RIGHT_KEY)).toBeNull();
});

test("the token leaves the address and stays in this tab", () => {
  window.location.hash = "#token=abc-_1";
  expect(takeToken(window.location, window.history, window.sessionStorage)).toBe("abc-_1");
  expect(window.location.href).not.toContain("abc");
  expect(takeToken(window.location, window.history, window.sessionStorage)).toBe("abc-_1");
});
