// Keys of the whole page.

import { flushSync } from "react-dom";
import { paste, redo, undo } from "../actions";
import { update } from "../store";
import { FILL_EVENT } from "../views/FillOffer";
import { isTyping, nameOfKey } from "./keys";

/** Takes a key of the whole page; to be placed on the document. */
export function onShortcut(event: KeyboardEvent): void {
  if (event.defaultPrevented) return;
  const name = nameOfKey(event);
  if (name === "F6" || name === "Shift+F6") {
    event.preventDefault();
    return focusPart(name === "F6" ? 1 : -1);
  }
  if (isTyping(event)) return;
  const doing = SHORTCUTS[name];
  if (!doing) return;
  event.preventDefault();
  doing();
}

/** Takes what the clipboard has, unless it is for a field; to be placed on the document. */
export function onPaste(event: ClipboardEvent): void {
  if (event.defaultPrevented || isTyping(event)) return;
  event.preventDefault();
  void paste(event.clipboardData?.getData("text/plain") ?? "");
}

const SHORTCUTS: Record<string, () => void> = {
  "Ctrl+Z": () => void undo(),
  "Ctrl+Shift+Z": () => void redo(),
  "Ctrl+Y": () => void redo(),
  "Ctrl+F": findByName,
  G: toOutline,
  M: () => document.dispatchEvent(new Event(FILL_EVENT)),
  "?": () => update({ dialog: { kind: "help" } }),
};

function findByName(): void {
  // The field comes with the diagram, and takes the very next key.
  flushSync(() => update({ middle: "diagram" }));
  document.getElementById("filter")?.focus();
}

function toOutline(): void {
  flushSync(() => update({ left: "outline" }));
  document.querySelector<HTMLElement>(".outline input")?.focus();
}

const PARTS = [
  ".header select",
  ".left input",
  ".flow, .sheet [tabindex='0']",
  ".right [role='tab'][tabindex='0']",
  ".bottom [role='tab'][tabindex='0']",
];

function focusPart(step: 1 | -1): void {
  const parts = PARTS.flatMap((selector) => document.querySelector<HTMLElement>(selector) ?? []);
  const at = parts.findIndex((part) => regionOf(part)?.contains(document.activeElement));
  parts.at((at + step + parts.length) % parts.length)?.focus();
}

const regionOf = (element: Element) => element.closest(".header, .left, .middle, .right, .bottom");
