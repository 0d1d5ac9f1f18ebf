// A client of the language server, as small as the editor of one text needs it (LSP 3.17).

import { Connection } from "../../connection";

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

interface OpenText {
  uri: string;
  version: number;
  text: string;
  onDiagnostics: (diagnostics: Diagnostic[]) => void;
}

/** One conversation with the language server; begun again with the text that is open when it is lost. */
export class LanguageClient {
  private readonly connection: Connection;
  private isReady = false;
  private open: OpenText | null = null;

  constructor(address: string, token: string, rootUri: string) {
    this.connection = new Connection(address, token, {
      onLink: (link) => {
        this.isReady = false;
        if (link === "open") this.begin(rootUri).catch(() => undefined); // lost: it is begun again
      },
      onNotification: (name, params) => this.told(name, params),
    });
    this.connection.open();
  }

  private async begin(rootUri: string): Promise<void> {
    await this.connection.call("initialize", {
      processId: null,
      rootUri,
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
    if (this.open) this.sendOpen(this.open);
  }

  /** Ends it for good. */
  close(): void {
    this.isReady = false;
    this.connection.close();
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
    const answer = await this.about<CompletionItem[] | { items: CompletionItem[] }>("completion", {
      position,
    });
    return answer === null ? [] : Array.isArray(answer) ? answer : answer.items;
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
    const answer = await this.connection.call(`textDocument/${method}`, {
      textDocument: { uri: this.open.uri },
      ...params,
    });
    return answer as T | null;
  }

  private notify(method: string, params: object): void {
    this.connection.notify(method, params);
  }

  private told(name: string, params: unknown): void {
    if (name !== "textDocument/publishDiagnostics") return;
    const { uri, diagnostics } = params as { uri: string; diagnostics: Diagnostic[] };
    if (this.open?.uri === uri) this.open.onDiagnostics(diagnostics);
  }
}

/** Returns the URI of a file below a folder, as language servers write it. */
export function fileUri(root: string, file: string): string {
  const path = `${root.replaceAll("\\", "/").replace(/\/$/, "")}/${file}`;
  const escaped = path
    .split("/")
    .map((segment) => encodeURIComponent(segment).replaceAll("%3A", ":"));
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
