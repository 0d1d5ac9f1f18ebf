// JSON-RPC 2.0 over one websocket, which is opened again when it is lost.

/** An error that the server told, or a connection that is not there; the message is for people. */
export class CallError extends Error {
  readonly code: number;
  readonly conflict: boolean;

  constructor(code: number, message: string, conflict = false) {
    super(message);
    this.code = code;
    this.conflict = conflict;
  }
}

/** What went wrong, for people. */
export const messageOf = (error: unknown): string =>
  error instanceof Error ? error.message : String(error);

/** Code of our own for calls that found no connection or lost it. */
export const LOST = -1;
/** Code for a fault of the server itself. */
export const INTERNAL_ERROR = -32603;

export type Link = "opening" | "open" | "lost" | "refused";

export interface Listener {
  /** The link changed; what the server greets with comes with `open`, `reason` with `refused`. */
  onLink(link: Link, hello: unknown, reason: string): void;
  onNotification(name: string, params: unknown): void;
}

/** Whom a page asks; a test gives another one. */
export interface Caller {
  call(method: string, params: unknown): Promise<unknown>;
}

interface Pending {
  resolve(value: unknown): void;
  reject(error: CallError): void;
}

interface Answer {
  id?: number | null;
  method?: string;
  params?: unknown;
  result?: unknown;
  /** Revision of the project of which the result is, at least. */
  revision?: number;
  error?: { code: number; message: string; data?: { conflict?: boolean } };
}

const SHORTEST_WAIT_MS = 300;
const LONGEST_WAIT_MS = 5000;
const POLICY_VIOLATION = 1008;

export class Connection implements Caller {
  private socket: WebSocket | null = null;
  private pending = new Map<number, Pending>();
  private next = 1;
  private wait = SHORTEST_WAIT_MS;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private link: Link = "opening";
  private readonly address: string;
  private readonly token: string;
  private readonly listener: Listener;

  constructor(address: string, token: string, listener: Listener) {
    this.address = address;
    this.token = token;
    this.listener = listener;
  }

  open(): void {
    clearTimeout(this.timer);
    const socket = new WebSocket(this.address);
    this.socket = socket;
    socket.onopen = () => this.greet(socket);
    socket.onmessage = (event) => this.take(String(event.data));
    socket.onclose = (event) => this.lose(socket, event.code);
  }

  /** Ends it for good. */
  close(): void {
    clearTimeout(this.timer);
    const socket = this.socket;
    this.socket = null;
    socket?.close();
  }

  call(method: string, params: unknown): Promise<unknown> {
    if (this.link !== "open") {
      return Promise.reject(new CallError(LOST, "There is no connection to the server."));
    }
    return this.send(this.next++, method, params);
  }

  /** Tells what needs no answer. */
  notify(method: string, params: object): void {
    this.post({ method, params });
  }

  private post(message: object): void {
    this.socket?.send(JSON.stringify({ jsonrpc: "2.0", ...message }));
  }

  private send(id: number, method: string, params: unknown): Promise<unknown> {
    return new Promise((resolve, reject) => {
      this.pending.set(id, { resolve, reject });
      this.post({ id, method, params });
    });
  }

  private greet(socket: WebSocket): void {
    this.send(0, "hello", { token: this.token }).then(
      (hello) => {
        this.wait = SHORTEST_WAIT_MS;
        this.tell("open", hello);
      },
      (error: CallError) => {
        if (error.code === LOST) return;
        this.refuse(error.message);
        socket.close();
      },
    );
  }

  private take(text: string): void {
    const answer = JSON.parse(text) as Answer;
    if (answer.method !== undefined) {
      // A language server may ask for what no page has, such as settings.
      if (answer.id !== undefined) this.post({ id: answer.id, result: null });
      else this.listener.onNotification(answer.method, answer.params);
      return;
    }
    const pending = this.pending.get(answer.id ?? -1);
    if (!pending) return;
    this.pending.delete(answer.id ?? -1);
    if (answer.error) {
      const { code, message, data } = answer.error;
      pending.reject(new CallError(code, message, data?.conflict ?? false));
    } else {
      pending.resolve(withRevision(answer.result, answer.revision));
    }
  }

  private lose(socket: WebSocket, code: number): void {
    if (socket !== this.socket) return;
    this.socket = null;
    const waiting = [...this.pending.values()];
    this.pending.clear();
    for (const call of waiting) call.reject(new CallError(LOST, "The connection was lost."));
    if (code === POLICY_VIOLATION && this.link !== "refused") {
      this.refuse("The server does not know this page. Open the address that it printed.");
    }
    if (this.link === "refused") return;
    this.tell("lost");
    this.timer = setTimeout(() => this.open(), this.wait);
    this.wait = Math.min(this.wait * 2, LONGEST_WAIT_MS);
  }

  private refuse(reason: string): void {
    this.tell("refused", null, reason);
  }

  private tell(link: Link, hello: unknown = null, reason = ""): void {
    this.link = link;
    this.listener.onLink(link, hello, reason);
  }
}

/** A result with the revision of which it is, unless it says so itself. */
function withRevision(result: unknown, revision: number | undefined): unknown {
  const isPlain = typeof result === "object" && result !== null && !Array.isArray(result);
  return isPlain && revision !== undefined ? { revision, ...result } : result;
}

export const TOKEN_KEY = "jausml-token";
/** Where a tab keeps the right to command, if its address had one. */
export const RIGHT_KEY = "jausml-command";

/** Takes the tokens out of the address, where a history would keep them, or from this tab. */
export function takeToken(location: Location, history: History, storage: Storage): string {
  const address = new URLSearchParams(location.hash.slice(1));
  const token = address.get("token");
  if (token) {
    const right = address.get("command");
    if (right) storage.setItem(RIGHT_KEY, right);
    else storage.removeItem(RIGHT_KEY);
    storage.setItem(TOKEN_KEY, token);
    history.replaceState(null, "", location.pathname + location.search);
  }
  return token ?? storage.getItem(TOKEN_KEY) ?? "";
}

/** Address of a socket of the server that sent this page. */
export function socketAddress(location: Location, path: string): string {
  const scheme = location.protocol === "https:" ? "wss:" : "ws:";
  return `${scheme}//${location.host}${path}`;
}
