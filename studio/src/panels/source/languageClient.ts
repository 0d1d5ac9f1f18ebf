// A client of the language server, as small as the editor of one text needs it (LSP 3.17).

export interface Position {
  line: number;
  character: number;
}

export interface Range {
  start: Position;
  end: Position;
}

export interface TextEdit {
  range: Range;
  newText: string;
}

export interface Diagnostic {
  range: Range;
  message: string;
  severity?: number;
  code?: string | number;
}

export interface CompletionItem {
  label: string;
  kind?: number;
  detail?: string;
  documentation?: string | { value: string };
  sortText?: string;
  textEdit?: TextEdit;
  additionalTextEdits?: TextEdit[];
}

export interface Hover {
  contents: { value: string } | string;
  range?: Range;
}

export interface WorkspaceEdit {
  changes?: Record<string, TextEdit[]>;
}

interface Answer {
  id?: number | string | null;
  method?: string;
  params?: unknown;
  result?: unknown;
  error?: { message: string };
}

/** What the client needs of a socket; a `WebSocket` has it. */
export type Socket = Pick<WebSocket, "send" | "close" | "onopen" | "onmessage" | "onclose">;

interface Pending {
  resolve(value: unknown): void;
  reject(error: Error): void;
}

interface OpenText {
  uri: string;
  version: number;
  text: string;
  onDiagnostics: (diagnostics: Diagnostic[], version: number | undefined) => void;
}

const LONGEST_WAIT_MS = 10_000;

/** One conversation with the language server; opened again when it is lost, with the text that is open. */
export class LanguageClient {
  private socket: Socket | null = null;
  private readonly pending = new Map<number, Pending>();
  private next = 1;
  private isReady = false;
  private wait = 500;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private open: OpenText | null = null;
  private readonly connect: () => Socket;
  private readonly token: string;
  private readonly rootUri: string;

  constructor(connect: () => Socket, token: string, rootUri: string) {
    this.connect = connect;
    this.token = token;
    this.rootUri = rootUri;
    this.begin();
  }

  private begin(): void {
    const socket = this.connect();
    this.socket = socket;
    socket.onopen = () => {
      this.greet().catch(() => socket.close());
    };
    socket.onmessage = (event) => this.take(String(event.data));
    socket.onclose = () => this.lose(socket);
  }

  private async greet(): Promise<void> {
    // The server takes the token first; what comes after it goes to the language server.
    await this.ask("hello", { token: this.token }, 0);
    await this.ask("initialize", {
      processId: null,
      rootUri: this.rootUri,
      capabilities: {
        general: { positionEncodings: ["utf-16"] },
        textDocument: {
          completion: { completionItem: { documentationFormat: ["plaintext"] } },
          hover: { contentFormat: ["plaintext", "markdown"] },
          rename: { prepareSupport: true },
          publishDiagnostics: { versionSupport: true },
        },
      },
    });
    this.notify("initialized", {});
    this.isReady = true;
    this.wait = 500;
    if (this.open) this.sendOpen(this.open);
  }

  private lose(socket: Socket): void {
    if (socket !== this.socket) return;
    this.socket = null;
    this.isReady = false;
    for (const each of this.pending.values())
      each.reject(new Error("The language server is gone."));
    this.pending.clear();
    this.timer = setTimeout(() => this.begin(), this.wait);
    this.wait = Math.min(this.wait * 2, LONGEST_WAIT_MS);
  }

  /** Ends it for good. */
  close(): void {
    clearTimeout(this.timer);
    const socket = this.socket;
    this.socket = null;
    this.isReady = false;
    for (const each of this.pending.values()) each.reject(new Error("The editor was closed."));
    this.pending.clear();
    socket?.close();
  }

  // The text that is open

  openText(uri: string, text: string, onDiagnostics: OpenText["onDiagnostics"]): void {
    this.closeText();
    this.open = { uri, text, version: 1, onDiagnostics };
    if (this.isReady) this.sendOpen(this.open);
  }

  changeText(text: string): void {
    if (!this.open || this.open.text === text) return;
    this.open.text = text;
    this.open.version += 1;
    if (!this.isReady) return;
    this.notify("textDocument/didChange", {
      textDocument: { uri: this.open.uri, version: this.open.version },
      contentChanges: [{ text }],
    });
  }

  closeText(): void {
    if (this.open && this.isReady)
      this.notify("textDocument/didClose", { textDocument: { uri: this.open.uri } });
    this.open = null;
  }

  private sendOpen({ uri, version, text }: OpenText): void {
    this.notify("textDocument/didOpen", {
      textDocument: { uri, languageId: "ros2jaus", version, text },
    });
  }

  // Questions about it

  async complete(position: Position): Promise<CompletionItem[]> {
    const found = await this.about<CompletionItem[] | { items: CompletionItem[] }>("completion", {
      position,
    });
    return found === null ? [] : Array.isArray(found) ? found : found.items;
  }

  hover(position: Position): Promise<Hover | null> {
    return this.about("hover", { position });
  }

  prepareRename(position: Position): Promise<Range | null> {
    return this.about("prepareRename", { position });
  }

  rename(position: Position, newName: string): Promise<WorkspaceEdit | null> {
    return this.about("rename", { position, newName });
  }

  format(): Promise<TextEdit[] | null> {
    return this.about("formatting", { options: { tabSize: 4, insertSpaces: true } });
  }

  private async about<T>(method: string, params: object): Promise<T | null> {
    if (!this.open || !this.isReady) return null;
    const answer = await this.ask(`textDocument/${method}`, {
      textDocument: { uri: this.open.uri },
      ...params,
    });
    return answer as T | null;
  }

  // The protocol

  private ask(method: string, params: object, id = this.next++): Promise<unknown> {
    return new Promise((resolve, reject) => {
      this.pending.set(id, { resolve, reject });
      this.send({ id, method, params });
    });
  }

  private notify(method: string, params: object): void {
    this.send({ method, params });
  }

  private send(message: object): void {
    this.socket?.send(JSON.stringify({ jsonrpc: "2.0", ...message }));
  }

  private take(text: string): void {
    const message = JSON.parse(text) as Answer;
    if (message.method !== undefined) this.told(message);
    else this.answered(message);
  }

  private answered({ id, error, result }: Answer): void {
    const pending = this.pending.get(Number(id));
    if (!pending) return;
    this.pending.delete(Number(id));
    if (error) pending.reject(new Error(error.message));
    else pending.resolve(result ?? null);
  }

  private told({ id, method, params }: Answer): void {
    if (method === "textDocument/publishDiagnostics") {
      const { uri, diagnostics, version } = params as {
        uri: string;
        diagnostics: Diagnostic[];
        version?: number;
      };
      if (this.open?.uri === uri) this.open.onDiagnostics(diagnostics, version);
    } else if (id !== undefined && id !== null) {
      // The server may ask for what this client does not have, such as settings.
      this.send({ id, result: null });
    }
  }
}

/** Returns the URI of a file below a folder, as language servers write it. */
export function fileUri(root: string, file: string): string {
  const path = `${root.replaceAll("\\", "/").replace(/\/$/, "")}/${file}`;
  const escaped = path.split("/").map((each) => encodeURIComponent(each).replaceAll("%3A", ":"));
  return `file://${path.startsWith("/") ? "" : "/"}${escaped.join("/")}`;
}

/** Returns the file below a folder that a URI names, null when it lies elsewhere. */
export function fileOf(root: string, uri: string): string | null {
  if (!uri.startsWith("file://")) return null;
  const path = decodeURIComponent(uri.slice("file://".length));
  const folder = `${root.replaceAll("\\", "/").replace(/\/$/, "")}/`;
  const absolute = folder.startsWith("/") ? path : path.replace(/^\//, "");
  return absolute.startsWith(folder) ? absolute.slice(folder.length) : null;
}
