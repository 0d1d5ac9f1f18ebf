import {
  autocompletion,
  type Completion,
  type CompletionContext,
  type CompletionResult,
} from "@codemirror/autocomplete";
import { type Diagnostic as Shown, setDiagnostics } from "@codemirror/lint";
import {
  ChangeSet,
  type ChangeSpec,
  type Extension,
  StateEffect,
  StateField,
  type Text,
} from "@codemirror/state";
import { type EditorView, hoverTooltip, keymap, type Panel, showPanel } from "@codemirror/view";
import type {
  CompletionItem,
  Diagnostic,
  LanguageClient,
  Position,
  TextEdit,
  WorkspaceEdit,
} from "./languageClient";

const SEVERITIES = ["error", "error", "warning", "info", "info"] as const;
const TYPES: Record<number, string> = {
  3: "function",
  5: "property",
  7: "class",
  10: "property",
  11: "constant",
  14: "keyword",
  17: "text",
  18: "variable",
  20: "enum",
};
const WORD = /^[\w./:`]*$/;

/** Returns the offset of a position; one past the end is the end. */
export function offsetOf(text: Text, { line, character }: Position): number {
  if (line >= text.lines) return text.length;
  const target = text.line(line + 1);
  return Math.min(target.from + character, target.to);
}

export function positionOf(text: Text, offset: number): Position {
  const line = text.lineAt(offset);
  return { line: line.number - 1, character: offset - line.from };
}

function spec(text: Text, edit: TextEdit): ChangeSpec {
  return {
    from: offsetOf(text, edit.range.start),
    to: offsetOf(text, edit.range.end),
    insert: edit.newText,
  };
}

/** Returns a text with edits of it made. */
export function edited(text: Text, edits: readonly TextEdit[]): string {
  const changes = edits.map((edit) => spec(text, edit));
  return ChangeSet.of(changes, text.length).apply(text).toString();
}

/** Shows what the language server says is wrong. */
export function showDiagnostics(view: EditorView, diagnostics: readonly Diagnostic[]): void {
  const text = view.state.doc;
  const shown: Shown[] = diagnostics.map((diagnostic) => {
    const from = offsetOf(text, diagnostic.range.start);
    return {
      from,
      to: Math.max(from, offsetOf(text, diagnostic.range.end)),
      severity: SEVERITIES[diagnostic.severity ?? 1] ?? "error",
      message: diagnostic.message,
      ...(diagnostic.code === undefined ? {} : { source: String(diagnostic.code) }),
    };
  });
  view.dispatch(setDiagnostics(view.state, shown));
}

// Completion

async function complete(
  client: LanguageClient,
  context: CompletionContext,
): Promise<CompletionResult | null> {
  const before = context.matchBefore(/[\w./:>(`]+/);
  if (!context.explicit && before === null) return null;
  const text = context.state.doc;
  client.changeText(text.toString());
  const items = await client.complete(positionOf(text, context.pos));
  if (context.aborted || items.length === 0) return null;
  const from = offsetOf(text, items[0]?.textEdit?.range.start ?? positionOf(text, context.pos));
  return { from, options: items.map((item) => option(item)), validFor: WORD };
}

function option(item: CompletionItem): Completion {
  const documentation =
    typeof item.documentation === "string" ? item.documentation : item.documentation?.value;
  return {
    label: item.label,
    ...(item.detail ? { detail: item.detail } : {}),
    ...(documentation ? { info: () => told(documentation) } : {}),
    type: TYPES[item.kind ?? 0] ?? "text",
    sortText: item.sortText ?? item.label,
    boost: item.sortText?.startsWith("0") ? 1 : 0,
    apply: (view, _completion, from, to) => take(view, item, from, to),
  };
}

function take(view: EditorView, item: CompletionItem, from: number, to: number): void {
  const insert = item.textEdit?.newText ?? item.label;
  const more = (item.additionalTextEdits ?? []).map((edit) => spec(view.state.doc, edit));
  const changes = view.state.changes([{ from, to, insert }, ...more]);
  view.dispatch({
    changes,
    selection: { anchor: changes.mapPos(to, 1) },
    userEvent: "input.complete",
    scrollIntoView: true,
  });
}

// Hover

/** A text of the model as an element: as text, whatever it holds. */
function told(text: string): HTMLElement {
  const element = document.createElement("div");
  element.className = "cm-told";
  element.textContent = text.replaceAll("**", "").replace(/^```\w*$/gm, "");
  return element;
}

function hovering(client: LanguageClient): Extension {
  return hoverTooltip(async (view, at) => {
    const text = view.state.doc;
    client.changeText(text.toString());
    const hover = await client.hover(positionOf(text, at)).catch(() => null);
    if (!hover) return null;
    const said = typeof hover.contents === "string" ? hover.contents : hover.contents.value;
    const pos = hover.range ? offsetOf(text, hover.range.start) : at;
    const end = hover.range ? offsetOf(text, hover.range.end) : at;
    return { pos, end, above: true, create: () => ({ dom: told(said) }) };
  });
}

// Rename

interface Renaming {
  at: Position;
  name: string;
  /** The text of which `at` is. */
  text: Text;
}

const askName = StateEffect.define<Renaming | null>();

function renaming(client: LanguageClient, onRename: (edit: WorkspaceEdit) => void): Extension {
  const asked = StateField.define<Renaming | null>({
    create: () => null,
    update: (value, transaction) =>
      transaction.effects.reduce(
        (last, effect) => (effect.is(askName) ? effect.value : last),
        value,
      ),
    provide: (field) =>
      showPanel.from(field, (value) =>
        value ? (view) => namePanel(view, value, client, onRename) : null,
      ),
  });
  const begin = (view: EditorView) => {
    const text = view.state.doc;
    const at = positionOf(text, view.state.selection.main.head);
    client.changeText(text.toString());
    client
      .prepareRename(at)
      .then((range) => {
        if (!range) return;
        const name = text.sliceString(offsetOf(text, range.start), offsetOf(text, range.end));
        view.dispatch({ effects: askName.of({ at, name, text }) });
      })
      .catch(() => undefined);
    return true;
  };
  return [asked, keymap.of([{ key: "F2", run: begin }])];
}

function namePanel(
  view: EditorView,
  { at, name, text }: Renaming,
  client: LanguageClient,
  onRename: (edit: WorkspaceEdit) => void,
): Panel {
  const dom = document.createElement("form");
  dom.className = "cm-rename";
  const label = document.createElement("label");
  const input = document.createElement("input");
  const fault = document.createElement("span");
  label.textContent = `Rename ${name} to `;
  input.value = name;
  fault.setAttribute("role", "alert");
  label.append(input);
  dom.append(label, fault);
  const close = () => {
    view.dispatch({ effects: askName.of(null) });
    view.focus();
  };
  dom.onsubmit = (event) => {
    event.preventDefault();
    client.rename(at, input.value).then(
      (edit) => {
        if (!view.state.doc.eq(text)) {
          fault.textContent = "The text has changed meanwhile: begin again.";
          return;
        }
        close();
        if (edit) onRename(edit);
      },
      (error: Error) => {
        fault.textContent = error.message;
      },
    );
  };
  dom.onkeydown = (event) => {
    if (event.key !== "Escape") return;
    event.stopPropagation();
    close();
  };
  return { dom, top: true, mount: () => input.select() };
}

/** All that the language server does for the text that is open. */
export function languageSupport(
  client: LanguageClient,
  onRename: (edit: WorkspaceEdit) => void,
): Extension {
  const format = (view: EditorView) => {
    const text = view.state.doc;
    client.changeText(text.toString());
    client
      .format()
      .then((edits) => {
        // What was typed meanwhile stands elsewhere than the answer thinks.
        if (edits?.length && view.state.doc.eq(text))
          view.dispatch({ changes: edits.map((edit) => spec(text, edit)) });
      })
      .catch(() => undefined);
    return true;
  };
  return [
    autocompletion({ override: [(context) => complete(client, context).catch(() => null)] }),
    hovering(client),
    renaming(client, onRename),
    keymap.of([{ key: "Shift-Alt-f", run: format }]),
  ];
}
