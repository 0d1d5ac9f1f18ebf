import { type KeyboardEvent, useEffect, useState } from "react";
import { choose } from "../../actions";
import { useSettled } from "../../answers";
import { useTree } from "../../keyboard/useTree";
import type { OutlineRow, Ref } from "../../protocol";
import { update, useRevision, useStudio } from "../../store";
import { Fault } from "../base/parts";
import { useAnswer } from "../base/useAnswer";

const PAUSE_MS = 80;
const NOTHING: Ref[] = [];

/** Everything that the file has, also what no diagram shows, as a tree with a search. */
export function Outline() {
  const file = useStudio((studio) => studio.file);
  const chosen = useStudio((studio) => studio.chosen);
  const revision = useRevision();
  const [typed, setTyped] = useState("");
  const [opened, setOpened] = useState<{ file: string; refs: Ref[] }>({ file, refs: NOTHING });
  const refs = opened.file === file ? opened.refs : NOTHING;
  const query = useSettled(typed.trim(), PAUSE_MS);
  const params = file ? { file, query, opened: refs } : null;
  // What was told before something was opened stays until the answer comes.
  const { value, error } = useAnswer("outline", params, revision, `${file} ${query}`);
  const rows = value?.rows ?? [];
  // Whoever presses Enter means what was typed, also where its rows are yet to come.
  const [isTaken, setTaken] = useState(false);
  const isCurrent = typed.trim() === query && value !== null;
  const { tree, active, setAt, focus, onKey } = useTree({
    rows,
    idOf: (row) => row.element,
    isOpen: (row) => (row.inner > 0 && row.depth > 0 && !query ? row.is_open : undefined),
    toggle,
  });

  // biome-ignore lint/correctness/useExhaustiveDependencies: the rows are those of what is current
  useEffect(() => {
    if (!isTaken || !isCurrent) return;
    setTaken(false);
    if (rows[0]) take(rows[0]);
  }, [isTaken, isCurrent]);

  function toggle({ element }: OutlineRow, isOpen: boolean) {
    const others = refs.filter((ref) => ref !== element);
    if (element) setOpened({ file, refs: isOpen ? [...others, element] : others });
  }

  function take(row: OutlineRow) {
    if (!row.element) return;
    setAt(row.element);
    update({ right: "form" });
    choose(row.element);
  }

  function onKeyDown(event: KeyboardEvent, row: OutlineRow) {
    onKey(event, row, (key) => {
      const isTaking = key === "Enter" || key === " ";
      if (isTaking) take(row);
      return isTaking;
    });
  }

  function onSearchKey(event: KeyboardEvent) {
    if (event.key === "ArrowDown") focus(rows[0]);
    else if (event.key === "Enter") setTaken(true);
    else if (event.key === "Escape" && typed) setTyped("");
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  return (
    <section className="outline" aria-label="Outline">
      <input
        type="search"
        placeholder="Search: name or kind"
        aria-label="Search all elements"
        spellCheck="false"
        value={typed}
        onChange={(event) => {
          setTyped(event.currentTarget.value);
          setTaken(false);
        }}
        onKeyDown={onSearchKey}
      />
      <Fault>{error}</Fault>
      <div role="tree" aria-label={`Elements of ${file}`} ref={tree}>
        {rows.map((row, index) => (
          <div
            key={row.element || `more ${index}`}
            role="treeitem"
            data-row={row.element}
            aria-level={row.depth + 1}
            aria-expanded={row.inner && !query ? row.is_open : undefined}
            aria-selected={row.element !== "" && row.element === chosen}
            aria-disabled={row.element === "" || undefined}
            tabIndex={row === active ? 0 : -1}
            className="outline-row"
            style={{ paddingLeft: 4 + 14 * row.depth }}
            onClick={() => take(row)}
            onDoubleClick={() => row.depth > 0 && toggle(row, !row.is_open)}
            onKeyDown={(event) => onKeyDown(event, row)}
          >
            <span
              className="outline-twist"
              aria-hidden="true"
              onClick={(event) => {
                event.stopPropagation();
                if (row.depth > 0) toggle(row, !row.is_open);
              }}
            >
              {row.inner && !query ? (row.is_open ? "▾" : "▸") : ""}
            </span>
            <span className="outline-label">{row.label}</span>{" "}
            <small>{[row.kind, row.note && `in ${row.note}`].filter(Boolean).join(" ")}</small>
          </div>
        ))}
      </div>
      {value && rows.length === 0 && <p className="quiet">Nothing fits.</p>}
    </section>
  );
}
