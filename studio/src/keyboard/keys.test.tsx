import { fireEvent, render } from "@testing-library/preact";
import { expect, test } from "vitest";
import { HELP, isTyping, nameOfKey } from "./keys";
import { onShortcut } from "./shortcuts";

const PLAIN = { ctrlKey: false, metaKey: false, shiftKey: false, altKey: false };

test("keys have one name each", () => {
  expect(nameOfKey({ ...PLAIN, key: "z", ctrlKey: true })).toBe("Ctrl+Z");
  expect(nameOfKey({ ...PLAIN, key: "Z", metaKey: true, shiftKey: true })).toBe("Ctrl+Shift+Z");
  expect(nameOfKey({ ...PLAIN, key: "?", shiftKey: true })).toBe("?");
  expect(nameOfKey({ ...PLAIN, key: "ArrowUp", altKey: true })).toBe("Alt+ArrowUp");
  expect(nameOfKey({ ...PLAIN, key: " " })).toBe("Space");
});

test("whoever types is left alone, also in a shadow tree", () => {
  const results: boolean[] = [];
  const note = (event: Event) => results.push(isTyping(event));
  document.addEventListener("keydown", note);
  const { container } = render(
    <>
      <input id="text" />
      <input id="box" type="checkbox" />
      <textarea id="area" />
      <button type="button" id="button">
        b
      </button>
      <div id="host" />
    </>,
  );
  const inner = document.createElement("div");
  inner.setAttribute("contenteditable", "true");
  container.querySelector("#host")?.attachShadow({ mode: "open" }).append(inner);
  for (const id of ["text", "box", "area", "button"]) {
    fireEvent.keyDown(container.querySelector(`#${id}`)!, { key: "z" });
  }
  fireEvent.keyDown(inner, { key: "z", composed: true });
  document.removeEventListener("keydown", note);
  expect(results).toEqual([true, false, true, false, true]);
});

test("the help tells of no key of the whole page that the page does not take", () => {
  for (const name of HELP[0]![1].flatMap(([names]) => names.split(", "))) {
    const [key = "", ...held] = name.split("+").reverse();
    const keys = { key, ctrlKey: held.includes("Ctrl"), shiftKey: held.includes("Shift") };
    const event = new KeyboardEvent("keydown", { ...keys, cancelable: true });
    onShortcut(event);
    expect(event.defaultPrevented, name).toBe(true);
  }
});
