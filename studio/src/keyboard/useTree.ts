import { type KeyboardEvent, useRef, useState } from "react";

interface Tree<R> {
  rows: readonly R[];
  /** The id of a row, which `data-row` of its element is too; empty for one that takes no focus. */
  idOf(row: R): string;
  /** Whether a row is open; undefined where there is nothing to open. */
  isOpen(row: R): boolean | undefined;
  toggle(row: R, isOpen: boolean): void;
}

/** Where the keyboard stands in a tree with one tab stop: arrows go up, down, in and out. */
export function useTree<R extends { depth: number }>({ rows, idOf, isOpen, toggle }: Tree<R>) {
  const [at, setAt] = useState("");
  const tree = useRef<HTMLDivElement>(null);
  const active = rows.find((row) => idOf(row) === at) ?? rows[0];

  function focus(row: R | undefined) {
    const id = row && idOf(row);
    if (!id) return;
    setAt(id);
    tree.current?.querySelector<HTMLElement>(`[data-row="${CSS.escape(id)}"]`)?.focus();
  }

  function go(key: string, row: R): boolean {
    const index = rows.indexOf(row);
    if (key === "ArrowDown") focus(rows[index + 1]);
    else if (key === "ArrowUp") focus(rows[index - 1]);
    else if (key === "Home") focus(rows[0]);
    else if (key === "End") focus(rows.findLast(idOf));
    else if (key === "ArrowRight" && isOpen(row) === false) toggle(row, true);
    else if (key === "ArrowRight") focus(rows[index + 1]);
    else if (key === "ArrowLeft" && isOpen(row)) toggle(row, false);
    else if (key === "ArrowLeft")
      focus(rows.slice(0, index).findLast((other) => other.depth < row.depth));
    else return false;
    return true;
  }

  /** Takes a key on a row; `act` does what others mean there, and is false for those of no meaning. */
  function onKey(event: KeyboardEvent, row: R, act: (key: string) => boolean) {
    if (event.target !== event.currentTarget || event.ctrlKey || event.metaKey || event.altKey)
      return;
    if (!go(event.key, row) && !act(event.key)) return;
    event.preventDefault();
    event.stopPropagation();
  }

  return { tree, active, setAt, focus, onKey };
}
