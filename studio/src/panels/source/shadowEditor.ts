import { closeBrackets, closeBracketsKeymap, completionKeymap } from "@codemirror/autocomplete";
import { defaultKeymap } from "@codemirror/commands";
import { xml } from "@codemirror/lang-xml";
import {
  bracketMatching,
  foldGutter,
  foldKeymap,
  indentOnInput,
  syntaxHighlighting,
} from "@codemirror/language";
import { lintGutter, lintKeymap } from "@codemirror/lint";
import { highlightSelectionMatches, searchKeymap } from "@codemirror/search";
import { EditorState, type Extension, StateEffect, StateField } from "@codemirror/state";
import {
  Decoration,
  type DecorationSet,
  drawSelection,
  EditorView,
  highlightActiveLine,
  keymap,
  lineNumbers,
} from "@codemirror/view";
import { colours, ros2jaus } from "./words";

/** Shows which part of the text belongs to what is chosen; null for none. */
export const showSpan = StateEffect.define<{ from: number; to: number } | null>();

const chosenMark = Decoration.mark({ class: "cm-chosen" });

const chosenSpan = StateField.define<DecorationSet>({
  create: () => Decoration.none,
  update(marks, transaction) {
    let shown = marks.map(transaction.changes);
    for (const effect of transaction.effects) {
      if (!effect.is(showSpan)) continue;
      const span = effect.value;
      shown =
        span && span.to > span.from
          ? Decoration.set([chosenMark.range(span.from, span.to)])
          : Decoration.none;
    }
    return shown;
  },
  provide: (field) => EditorView.decorations.from(field),
});

const look = EditorView.theme({
  "&": { height: "100%", color: "var(--ink)", backgroundColor: "var(--ground)", fontSize: "13px" },
  "&.cm-focused": { outline: "2px solid var(--chosen)", outlineOffset: "-2px" },
  ".cm-scroller": { fontFamily: "ui-monospace, monospace", lineHeight: "1.5" },
  ".cm-content": { caretColor: "var(--ink)" },
  ".cm-cursor": { borderLeftColor: "var(--ink)" },
  ".cm-gutters": { backgroundColor: "var(--raised)", color: "var(--muted)", border: "none" },
  ".cm-activeLine, .cm-activeLineGutter": {
    backgroundColor: "color-mix(in srgb, var(--ink) 5%, transparent)",
  },
  ".cm-chosen": { backgroundColor: "color-mix(in srgb, var(--chosen) 8%, transparent)" },
  "&.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground, .cm-selectionBackground":
    {
      background: "color-mix(in srgb, var(--chosen) 35%, transparent)",
    },
  ".cm-tooltip": {
    backgroundColor: "var(--raised)",
    color: "var(--ink)",
    border: "1px solid var(--faint)",
    borderRadius: "4px",
    maxWidth: "34rem",
  },
  ".cm-tooltip.cm-tooltip-autocomplete > ul > li[aria-selected]": {
    backgroundColor: "var(--chosen)",
    color: "var(--ground)",
  },
  ".cm-panels": { backgroundColor: "var(--raised)", color: "var(--ink)" },
  ".cm-told": { padding: "6px 10px", whiteSpace: "pre-wrap", overflowWrap: "anywhere" },
  ".cm-rename": { padding: "6px 10px", display: "flex", gap: "8px", alignItems: "center" },
});

/** What an editor of one notation has, whatever is asked of the language server. */
export function basics(notation: "xmi" | "text", isEditable: boolean): Extension[] {
  const editing = [
    indentOnInput(),
    closeBrackets(),
    lintGutter(),
    keymap.of([...closeBracketsKeymap, ...completionKeymap, ...lintKeymap]),
  ];
  return [
    lineNumbers(),
    foldGutter(),
    drawSelection(),
    highlightActiveLine(),
    highlightSelectionMatches(),
    bracketMatching(),
    notation === "text" ? ros2jaus : xml(),
    syntaxHighlighting(colours),
    chosenSpan,
    look,
    keymap.of([...defaultKeymap, ...searchKeymap, ...foldKeymap]),
    EditorState.readOnly.of(!isEditable),
    EditorState.tabSize.of(4),
    isEditable ? editing : [],
    EditorView.contentAttributes.of({
      tabindex: "0",
      "aria-label": isEditable ? "Text of the file" : "Text of the file, read-only",
    }),
  ];
}

/**
 * Opens an editor in a shadow root of an element: there its styles are adopted sheets, which the
 * policy of the page allows, and no style elements, which it does not.
 */
export function openEditor(host: HTMLElement, text: string, extensions: Extension): EditorView {
  const root = host.shadowRoot ?? host.attachShadow({ mode: "open" });
  return new EditorView({ doc: text, extensions, parent: root, root });
}
