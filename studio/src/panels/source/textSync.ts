import { Annotation, type ChangeSpec } from "@codemirror/state";
import type { EditorView } from "@codemirror/view";
import type { FileText } from "../../protocol";
import { asInFile, type LineEnd, lines } from "./lines";
import { merged } from "./merging";

const PAUSE_MS = 400;

/** Marks what came from outside and is not to be written back. */
export const fromOutside = Annotation.define<boolean>();

export interface SyncState {
  /** Whether there is something that is not written yet. */
  isUnsaved: boolean;
  /** Why it could not be written. */
  error: string;
  /** The text of the file where others changed what was changed here too; null for none. */
  theirs: string | null;
}

interface SyncFile {
  read(): Promise<FileText>;
  write(text: string, base: number): Promise<{ revision: number }>;
}

export const IN_STEP: SyncState = { isUnsaved: false, error: "", theirs: null };

/**
 * Keeps an editor and a file in step: what is typed is written after a pause, what others write
 * comes in without moving the cursor, and what both changed is shown and not lost.
 */
export class TextSync {
  private synced: string;
  private base: number;
  private state = IN_STEP;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private turn: Promise<void> = Promise.resolve();
  private isOver = false;
  private readonly end: LineEnd;
  private readonly view: EditorView;
  private readonly file: SyncFile;
  private readonly onState: (state: SyncState) => void;

  constructor(
    view: EditorView,
    file: SyncFile,
    start: FileText,
    onState: (state: SyncState) => void,
  ) {
    const { text, end } = lines(start.text);
    this.view = view;
    this.file = file;
    this.synced = text;
    this.base = start.revision;
    this.end = end ?? "\n";
    this.onState = onState;
  }

  /** Takes notice that the text of the editor was changed here. */
  touched(): void {
    clearTimeout(this.timer);
    this.tell({ isUnsaved: true });
    this.timer = setTimeout(() => this.flush(), PAUSE_MS);
  }

  /** Writes now what is not written yet. */
  flush(): Promise<void> {
    clearTimeout(this.timer);
    return this.inTurn(() => this.write());
  }

  /** Reads the file again, since it may have changed. */
  pull(): Promise<void> {
    return this.inTurn(() => this.read());
  }

  /** Ends a conflict: what is here is written over what others wrote. */
  keepOwn(): Promise<void> {
    const theirs = this.state.theirs;
    if (theirs === null) return Promise.resolve();
    this.synced = theirs;
    this.tell({ theirs: null });
    return this.flush();
  }

  /** Ends a conflict: what others wrote takes the place of what is here. */
  takeTheirs(): void {
    const theirs = this.state.theirs;
    if (theirs === null) return;
    this.apply({ from: 0, to: this.view.state.doc.length, insert: theirs });
    this.synced = theirs;
    this.tell({ theirs: null, isUnsaved: false, error: "" });
  }

  /** Goes on with what was typed before and is not in the file: which of both holds is asked. */
  resume(own: string): void {
    this.apply({ from: 0, to: this.view.state.doc.length, insert: own });
    this.tell({ theirs: this.synced, isUnsaved: true });
  }

  /** What is not written; null for nothing. */
  get left(): string | null {
    return this.own === this.synced ? null : this.own;
  }

  /** Writes what is left, and then nothing any more. Returns what could not be written. */
  async close(): Promise<string | null> {
    await this.flush();
    this.isOver = true;
    return this.left;
  }

  private get own(): string {
    return this.view.state.doc.toString();
  }

  private inTurn(step: () => Promise<void>): Promise<void> {
    this.turn = this.turn.then(step).catch((error: unknown) => {
      this.tell({ error: error instanceof Error ? error.message : String(error) });
    });
    return this.turn;
  }

  private async write(): Promise<void> {
    const own = this.own;
    if (this.isOver || this.state.theirs !== null) return;
    if (own === this.synced) return this.tell({ isUnsaved: false, error: "" });
    try {
      const { revision } = await this.file.write(asInFile(own, this.end), this.base);
      this.base = revision;
      this.synced = own;
    } catch (error) {
      if (!(error as { conflict?: boolean }).conflict) throw error;
      await this.read();
      if (this.state.theirs === null) this.touched();
      return;
    }
    this.tell({ isUnsaved: this.own !== own, error: "" });
  }

  private async read(): Promise<void> {
    const { text: stored, revision } = await this.file.read();
    const theirs = lines(stored).text;
    if (this.isOver) return;
    this.base = revision;
    if (this.state.theirs !== null) return this.tell({ theirs });
    // What could not be written may be now.
    if (theirs === this.synced) return this.left === null ? undefined : this.touched();
    const changes = merged(this.synced, this.own, theirs);
    if (changes === null) return this.tell({ theirs, isUnsaved: true });
    this.apply(changes);
    this.synced = theirs;
    this.tell({ isUnsaved: this.own !== theirs });
  }

  private apply(changes: ChangeSpec): void {
    this.view.dispatch({ changes, annotations: fromOutside.of(true) });
  }

  private tell(change: Partial<SyncState>): void {
    this.state = { ...this.state, ...change };
    this.onState(this.state);
  }
}
