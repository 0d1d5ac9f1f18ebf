import { Prec } from "@codemirror/state";
import { EditorView, keymap } from "@codemirror/view";
import { useEffect, useRef, useState } from "react";
import { ask, draftOf, dropDraft, keepDraft, messageOf, redo, undo } from "../../actions";
import { socketAddress, TOKEN_KEY } from "../../connection";
import type { FileText } from "../../protocol";
import { useStudio } from "../../store";
import { Fault } from "../base/parts";
import { fileOf, fileUri, LanguageClient, type WorkspaceEdit } from "./languageClient";
import { edited, languageSupport, showDiagnostics } from "./languageSupport";
import { lines } from "./lines";
import { basics, openEditor, showSpan } from "./shadowEditor";
import { fromOutside, IN_STEP, type SyncState, TextSync } from "./textSync";

const CURSOR_PAUSE_MS = 250;

interface Props {
  root: string;
  file: string;
  notation: "xmi" | "text";
  /** Counts changes of the project: the file is read again at each. */
  revision: number;
  /** What is chosen. */
  span: { start: number; end: number } | null;
  /** The cursor was set to this place. */
  onCursor: (offset: number) => void;
}

/** The text of a file: to be edited where it is ros2jaus, else to be read. */
export function TextEditor(props: Props) {
  const { root, file, notation, revision, span } = props;
  const host = useRef<HTMLDivElement>(null);
  const opened = useRef<Opened | null>(null);
  const latest = useRef(props);
  latest.current = props;
  const [state, setState] = useState<SyncState>(IN_STEP);
  const [fault, setFault] = useState("");
  const [isOpen, setOpen] = useState(false);
  const isLinked = useStudio((studio) => studio.link === "open");

  useEffect(() => {
    let isWanted = true;
    const element = host.current;
    setState(IN_STEP);
    ask("text", { file }).then(
      (start) => {
        if (!isWanted || element === null) return;
        setFault("");
        opened.current = open(
          element,
          { root, file, notation, start, onState: setState, onFault: setFault },
          (offset) => latest.current.onCursor(offset),
        );
        setOpen(true);
      },
      (error: unknown) => isWanted && setFault(messageOf(error)),
    );
    return () => {
      isWanted = false;
      opened.current?.close();
      opened.current = null;
      setOpen(false);
    };
  }, [root, file, notation]);

  // biome-ignore lint/correctness/useExhaustiveDependencies: each revision may have changed the file
  useEffect(() => {
    if (isLinked) opened.current?.sync.pull();
  }, [revision, isLinked]);

  useEffect(() => {
    if (isOpen) opened.current?.show(span);
  }, [span, isOpen]);

  return (
    <div className="text-editor">
      {fault && <Fault>{fault}</Fault>}
      {state.error && <Fault>{`Not written: ${state.error}`}</Fault>}
      {state.theirs !== null && (
        <div className="conflict" role="alert">
          <p>
            The file was changed elsewhere, at a place that was changed here too. Nothing is lost
            yet:
          </p>
          <button type="button" onClick={() => opened.current?.sync.keepOwn()}>
            Keep what is here
          </button>{" "}
          <button type="button" onClick={() => opened.current?.sync.takeTheirs()}>
            Take what is in the file
          </button>
          <pre>{state.theirs}</pre>
        </div>
      )}
      <div className="editor-host" ref={host} data-keys="own" />
      <small className="quiet">
        {state.isUnsaved ? "not written yet" : "in step with the file"}
      </small>
    </div>
  );
}

interface Opened {
  sync: TextSync;
  show: (span: Props["span"]) => void;
  close: () => void;
}

interface Opening {
  root: string;
  file: string;
  notation: "xmi" | "text";
  start: FileText;
  onState: (state: SyncState) => void;
  onFault: (message: string) => void;
}

function open(host: HTMLElement, opening: Opening, onCursor: (offset: number) => void): Opened {
  const { root, file, notation, start } = opening;
  const { text, end } = lines(start.text);
  const isEditable = start.editable && end !== null;
  if (start.editable && end === null)
    opening.onFault("The lines of this file end in different ways: read-only.");

  const client = notation === "text" && isEditable ? openClient(root) : null;
  let cursor: ReturnType<typeof setTimeout> | undefined;

  const listener = EditorView.updateListener.of((update) => {
    if (update.docChanged) {
      client?.changeText(update.state.doc.toString());
      const isOwn = update.transactions.some(
        (transaction) => transaction.docChanged && !transaction.annotation(fromOutside),
      );
      if (isOwn) sync.touched();
    }
    // Where a person set the cursor; not where the page did, nor while text is typed.
    const isSet = update.transactions.some((transaction) => transaction.isUserEvent("select"));
    if (!isSet || update.docChanged) return;
    clearTimeout(cursor);
    cursor = setTimeout(() => onCursor(view.state.selection.main.head), CURSOR_PAUSE_MS);
  });

  const step = (way: () => Promise<unknown>) => () => {
    sync
      .flush()
      // What is not in the file is not in the history: another edit would be undone.
      .then(() => (sync.left === null ? way() : undefined))
      .catch((error: unknown) => opening.onFault(messageOf(error)));
    return true;
  };
  const keys = Prec.high(
    keymap.of([
      { key: "Mod-z", run: step(undo), preventDefault: true },
      { key: "Mod-Shift-z", run: step(redo), preventDefault: true },
      { key: "Mod-y", run: step(redo), preventDefault: true },
      { key: "Mod-s", run: step(() => Promise.resolve()), preventDefault: true },
    ]),
  );
  const view = openEditor(host, text, [
    basics(notation, isEditable),
    isEditable ? keys : [],
    client ? languageSupport(client, (edit) => rename(edit)) : [],
    listener,
  ]);
  const sync = new TextSync(
    view,
    {
      read: () => ask("text", { file }),
      write: (own, base) => ask("write", { file, text: own, base }),
    },
    start,
    opening.onState,
  );
  const place = [`${file}#/`, "text"] as const;
  const kept = draftOf(...place);
  dropDraft(...place); // it is in the editor now
  if (kept && kept.text !== text) sync.resume(kept.text);
  function keep(left: string | null) {
    const [element, field] = place;
    const why = "It is not in the file";
    if (left !== null) keepDraft({ element, field, what: `text of ${file}`, text: left, why });
  }
  const leave = () => keep(sync.left);
  window.addEventListener("pagehide", leave);
  client?.openText(fileUri(root, file), view.state.doc.toString(), (diagnostics) =>
    showDiagnostics(view, diagnostics),
  );

  /** Makes the edits of a rename: here by typing them, in other files at once. */
  async function rename({ changes = {} }: WorkspaceEdit) {
    try {
      for (const [uri, edits] of Object.entries(changes)) {
        const other = fileOf(root, uri);
        if (other === file) {
          const renamed = edited(view.state.doc, edits);
          view.dispatch({ changes: { from: 0, to: view.state.doc.length, insert: renamed } });
          await sync.flush();
        } else if (other !== null) {
          const there = await ask("text", { file: other });
          const state = view.state.toText(lines(there.text).text);
          await ask("write", { file: other, text: edited(state, edits), base: there.revision });
        }
      }
    } catch (error) {
      opening.onFault(messageOf(error));
    }
  }

  return {
    sync,
    show(span) {
      if (span === null) return view.dispatch({ effects: showSpan.of(null) });
      const { length } = view.state.doc;
      const shown = { from: Math.min(span.start, length), to: Math.min(span.end, length) };
      view.dispatch({ effects: showSpan.of(shown) });
      // A cursor that stands in it was perhaps what chose it.
      if (view.hasFocus) return undefined;
      view.dispatch({
        selection: { anchor: shown.from },
        effects: EditorView.scrollIntoView(shown.from, { y: "start", yMargin: 40 }),
      });
      return undefined;
    },
    close() {
      clearTimeout(cursor);
      window.removeEventListener("pagehide", leave);
      const last = sync.close().then(keep);
      client?.close();
      last.finally(() => view.destroy());
    },
  };
}

function openClient(root: string): LanguageClient {
  const address = socketAddress(window.location, "/language");
  return new LanguageClient(address, sessionStorage.getItem(TOKEN_KEY) ?? "", fileUri(root, ""));
}
