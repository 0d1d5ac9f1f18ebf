import { HighlightStyle, StreamLanguage, type StringStream } from "@codemirror/language";
import { tags } from "@lezer/highlight";

interface State {
  /** What ends the comment that is open, empty for none. */
  within: "" | "comment" | "documentation";
}

const STATEMENTS = /^(?:import|JAUS|ROS|struct|table|vector|ignore|clock|new)(?![\w./`])(?!\s*:)/;
const CONSTANTS = /^(?:true|false)(?![\w./`])/;
const FEATURE = /^[A-Za-z_]\w*(?=:)/;
const ELEMENT = /^[a-z][a-z_]*(?=\s+[\w`.{])/;
const NUMBER =
  /^[+-]?(?:0[xX][0-9a-fA-F]+|\d+\.\d+\.\d+|\d+(?:\.\d*)?(?:[eE][+-]?\d+)?|Infinity)(?![\w.])/;
const TEXT = /^@?"(?:[^"\\]|\\.)*"?/;
const QUOTED = /^`(?:[^`\\]|\\.)*`?/;
const OPERATORS = /^(?:<->|->|=>|<=|[=~])/;
const WORD = /^[\w./]+/;

function comment(stream: StringStream, state: State): string {
  const kind = state.within === "documentation" ? "docComment" : "blockComment";
  if (stream.skipTo("*/")) {
    stream.match("*/");
    state.within = "";
  } else stream.skipToEnd();
  return kind;
}

function token(stream: StringStream, state: State): string | null {
  if (state.within !== "") return comment(stream, state);
  if (stream.eatSpace()) return null;
  if (stream.match("//")) {
    stream.skipToEnd();
    return "lineComment";
  }
  if (stream.match("/*")) {
    state.within = stream.match(/^\*(?![*/])/) ? "documentation" : "comment";
    return comment(stream, state);
  }
  if (stream.match(TEXT)) return "string";
  if (stream.match(QUOTED)) return "variableName";
  if (stream.match(STATEMENTS)) return "keyword";
  if (stream.match(CONSTANTS)) return "bool";
  if (stream.match(FEATURE)) return "propertyName";
  if (stream.match(NUMBER)) return "number";
  if (stream.match(OPERATORS)) return "operator";
  // The first word of a line that a name follows is the class of an element.
  if (stream.string.slice(0, stream.pos).trim() === "" && stream.match(ELEMENT)) return "typeName";
  if (stream.match(WORD)) return "name";
  stream.next();
  return null;
}

/** The words of ros2jaus as they are coloured; what they mean the language server knows. */
export const ros2jaus = StreamLanguage.define<State>({
  name: "ros2jaus",
  startState: () => ({ within: "" }),
  token,
  languageData: {
    commentTokens: { line: "//", block: { open: "/*", close: "*/" } },
    closeBrackets: { brackets: ["{", "(", "[", '"', "`"] },
    indentOnInput: /^\s*[})\]]$/,
  },
});

/** A colour that can be read on what is selected, too. */
const read = (name: string) => `color-mix(in srgb, var(--${name}) 70%, var(--ink))`;

/** Colours of words, the same for text and XMI; the page's style sheet names the values. */
export const colours = HighlightStyle.define([
  { tag: [tags.comment, tags.lineComment, tags.blockComment], color: read("muted") },
  { tag: tags.docComment, color: read("muted"), fontStyle: "italic" },
  { tag: [tags.keyword, tags.processingInstruction], color: read("bridge"), fontWeight: "bold" },
  { tag: [tags.typeName, tags.tagName], color: read("jaus") },
  { tag: [tags.propertyName, tags.attributeName], color: read("ros") },
  { tag: [tags.string, tags.attributeValue], color: read("error") },
  { tag: [tags.number, tags.bool], color: read("bridge") },
  { tag: [tags.operator, tags.angleBracket], color: read("muted") },
]);
