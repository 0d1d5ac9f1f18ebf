import { Text } from "@codemirror/state";
import { EditorView, runScopeHandlers } from "@codemirror/view";
import { describe, expect, it } from "vitest";
import type { LanguageClient } from "./languageClient";
import { edited, languageSupport, offsetOf, positionOf } from "./languageSupport";
import { asInFile, lines } from "./lines";
import { ros2jaus } from "./words";

describe("ends of lines", () => {
  it("knows one way, the other, and a mixture", () => {
    expect(lines("a\nb").end).toBe("\n");
    expect(lines("a\r\nb\r\n")).toEqual({ text: "a\nb\n", end: "\r\n" });
    expect(lines("a\r\nb\n").end).toBeNull();
    expect(lines("a\rb\n").end).toBeNull();
  });

  it("gives back what was there", () => {
    const file = "a\r\nb\r\nc";
    expect(asInFile(lines(file).text, "\r\n")).toBe(file);
  });
});

describe("places of the language server", () => {
  const text = Text.of(["first", "second"]);

  it("goes both ways, and ends at the end", () => {
    expect(offsetOf(text, { line: 1, character: 2 })).toBe(8);
    expect(positionOf(text, 8)).toEqual({ line: 1, character: 2 });
    expect(offsetOf(text, { line: 9, character: 0 })).toBe(12);
    expect(offsetOf(text, { line: 0, character: 99 })).toBe(5);
  });

  it("makes several edits of the text as it was", () => {
    const range = (line: number, from: number, to: number) => ({
      start: { line, character: from },
      end: { line, character: to },
    });
    const edits = [
      { range: range(0, 0, 5), newText: "1" },
      { range: range(1, 0, 6), newText: "2" },
    ];
    expect(edited(text, edits)).toBe("1\n2");
  });
});

it("formats nothing where more was typed while it was asked", async () => {
  let answer = (_: unknown) => {};
  const format = () => new Promise((done) => (answer = done));
  const client = { changeText() {}, format } as unknown as LanguageClient;
  const view = new EditorView({ doc: "a b\n", extensions: languageSupport(client, () => {}) });
  const keys = { key: "F", code: "KeyF", keyCode: 70, shiftKey: true, altKey: true };
  runScopeHandlers(view, new KeyboardEvent("keydown", keys), "editor");
  view.dispatch({ changes: { from: 0, insert: "typed " } });
  const range = { start: { line: 0, character: 1 }, end: { line: 0, character: 2 } };
  answer([{ range, newText: "" }]);
  await Promise.resolve();
  expect(view.state.doc.toString()).toBe("typed a b\n");
  view.destroy();
});

describe("the words of ros2jaus", () => {
  function names(text: string): string[] {
    const places: string[] = [];
    ros2jaus.parser.parse(text).iterate({
      enter: (node) => {
        if (node.name !== "Document") places.push(`${node.name}:${text.slice(node.from, node.to)}`);
      },
    });
    return places;
  }

  it("tells comments, elements, features, numbers and texts apart", () => {
    expect(names('// why\nnode controller {\n rate: 10 "text" <-> true\n}')).toEqual([
      "lineComment:// why",
      "typeName:node",
      "name:controller",
      "propertyName:rate",
      "number:10",
      'string:"text"',
      "operator:<->",
      "bool:true",
    ]);
  });

  it("keeps a comment over lines", () => {
    expect(names("/** what\n it is */ JAUS x")).toEqual([
      "docComment:/** what",
      "docComment: it is */",
      "keyword:JAUS",
      "name:x",
    ]);
  });
});
