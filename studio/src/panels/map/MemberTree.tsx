import { type DragEvent, type KeyboardEvent, useEffect, useMemo, useState } from "react";
import { useTree } from "../../keyboard/useTree";
import type { GraphEnd, Ref } from "../../protocol";
import { type Filter, type MemberRow, openAtFirst, type SideRows, shownRows } from "./rows";

const DRAGGED_MEMBER = "application/x-jausml-member";

interface Props {
  side: SideRows;
  query: string;
  filter: Filter;
  /** Where a connection begins, while one is drawn. */
  begun: GraphEnd | null;
  chosen: Ref;
  onBegin: (end: GraphEnd | null) => void;
  /** A connection was drawn. */
  onConnect: (source: GraphEnd, target: GraphEnd) => void;
  /** A member is to be filled without a source. */
  onFill: (target: GraphEnd) => void;
  onChoose: (element: Ref) => void;
  onRemove: (element: Ref, label: string) => void;
}

/** One end of a map: its members as a tree, each with what fills or reads it. */
export function MemberTree(props: Props) {
  const { side, begun } = props;
  const { rows } = side;
  const [opened, setOpened] = useState(() => openAtFirst(rows));
  const shown = useMemo(
    () => shownRows(rows, props.query, props.filter, opened),
    [rows, props.query, props.filter, opened],
  );
  const { tree, active, setAt, onKey } = useTree({
    rows: shown,
    idOf: (row) => row.path,
    isOpen: (row) => (row.hasInner ? opened.has(row.path) : undefined),
    toggle: (row, isOpen) => toggle(row.path, isOpen),
  });

  // What is mapped for the first time is seen.
  useEffect(() => {
    setOpened((before) => {
      const missing = [...openAtFirst(rows)].filter((key) => !before.has(key));
      return missing.length > 0 ? new Set([...before, ...missing]) : before;
    });
  }, [rows]);

  function toggle(path: string, isOpen: boolean) {
    setOpened((before) => {
      const after = new Set(before);
      if (isOpen) after.add(path);
      else after.delete(path);
      return after;
    });
  }

  function finish(row: MemberRow) {
    const end = { node: row.node, port: row.path };
    if (begun === null) return;
    props.onConnect(begun, end);
    props.onBegin(null);
  }

  /** Does what a key means on a row; false for keys that mean nothing. */
  function act(key: string, row: MemberRow): boolean {
    const use = row.uses[0];
    if ((key === "c" || key === "Enter") && begun !== null) finish(row);
    else if (key === "c") props.onBegin({ node: row.node, port: row.path });
    else if (key === "f") props.onFill({ node: row.node, port: row.path });
    else if (key === "Enter" && use) props.onChoose(use.element);
    else if (key === "Enter" && row.hasInner) toggle(row.path, !opened.has(row.path));
    else if (key === "Delete" && use) props.onRemove(use.element, use.edge.title);
    else return false;
    return true;
  }

  return (
    <div className="member-tree" ref={tree}>
      <h2>
        {side.title} <small>{side.side === "jaus" ? "JAUS" : "ROS"}</small>
      </h2>
      <div role="tree" aria-label={`Members of ${side.title}`}>
        {shown.map((row) => (
          <Member
            key={row.path}
            {...props}
            row={row}
            isOpen={opened.has(row.path)}
            isActive={row === active}
            onFocus={() => setAt(row.path)}
            onToggle={(isOpen) => toggle(row.path, isOpen)}
            onFinish={() => finish(row)}
            onKeyDown={(event) => onKey(event, row, (key) => act(key, row))}
          />
        ))}
      </div>
      {shown.length === 0 && <p className="quiet">No member fits.</p>}
    </div>
  );
}

interface MemberProps extends Props {
  row: MemberRow;
  isOpen: boolean;
  isActive: boolean;
  onFocus: () => void;
  onToggle: (isOpen: boolean) => void;
  onFinish: () => void;
  onKeyDown: (event: KeyboardEvent) => void;
}

function Member(props: MemberProps) {
  const { row, isOpen, isActive, begun } = props;
  const [isOver, setOver] = useState(false);
  const isBegun = begun?.node === row.node && begun.port === row.path;
  const isFilled = row.uses.length > 0 || row.mark.startsWith("=") || row.mark === "ignored";

  function onDrop(event: DragEvent) {
    setOver(false);
    const text = event.dataTransfer.getData(DRAGGED_MEMBER);
    if (!text) return;
    event.preventDefault();
    props.onConnect(JSON.parse(text) as GraphEnd, { node: row.node, port: row.path });
  }

  return (
    <div
      role="treeitem"
      aria-label={[row.label, row.note, row.mark, ...row.uses.map((use) => use.text)]
        .filter(Boolean)
        .join(", ")}
      aria-level={row.depth + 1}
      aria-expanded={row.hasInner ? isOpen : undefined}
      aria-selected={row.uses.some((use) => use.element === props.chosen)}
      tabIndex={isActive ? 0 : -1}
      data-row={row.path}
      className={`member ${isOver ? "is-over" : ""} ${isBegun ? "is-begun" : ""} ${isFilled ? "" : "is-unmapped"}`}
      style={{ paddingLeft: 4 + 16 * row.depth }}
      draggable
      onFocus={props.onFocus}
      onKeyDown={props.onKeyDown}
      onDragStart={(event) => {
        event.dataTransfer.effectAllowed = "link";
        event.dataTransfer.setData(
          DRAGGED_MEMBER,
          JSON.stringify({ node: row.node, port: row.path }),
        );
      }}
      onDragOver={(event) => {
        if (!event.dataTransfer.types.includes(DRAGGED_MEMBER)) return;
        event.preventDefault();
        event.dataTransfer.dropEffect = "link";
        setOver(true);
      }}
      onDragLeave={() => setOver(false)}
      onDrop={onDrop}
    >
      <span className="member-name">
        {row.hasInner ? (
          <button
            type="button"
            className="twist"
            tabIndex={-1}
            aria-label={`${isOpen ? "Close" : "Open"} ${row.label}`}
            onClick={() => props.onToggle(!isOpen)}
          >
            {isOpen ? "▾" : "▸"}
          </button>
        ) : (
          <span className="twist" />
        )}
        {row.label} <small className="quiet">{row.note}</small>
        {row.mark && (
          <span className={`badge ${row.mark.startsWith("required") ? "badge-strong" : ""}`}>
            {row.mark}
          </span>
        )}
      </span>
      <span className="member-uses">
        {row.uses.map((use) => (
          <span key={use.edge.id} className={`use use-${use.edge.kind}`}>
            <button
              type="button"
              tabIndex={-1}
              className="link"
              onClick={() => props.onChoose(use.element)}
            >
              {use.text}
            </button>
            <button
              type="button"
              tabIndex={-1}
              className="small"
              aria-label={`Delete ${use.edge.title}`}
              onClick={() => props.onRemove(use.element, use.edge.title)}
            >
              ×
            </button>
          </span>
        ))}
        <span className="on-demand">
          {begun !== null && !isBegun ? (
            <button type="button" tabIndex={-1} onClick={props.onFinish}>
              to here
            </button>
          ) : (
            <button
              type="button"
              tabIndex={-1}
              title="Begin an assignment here (c)"
              onClick={() => props.onBegin(isBegun ? null : { node: row.node, port: row.path })}
            >
              {isBegun ? "cancel" : "map…"}
            </button>
          )}
          {begun === null && row.uses.length === 0 && (
            <button
              type="button"
              tabIndex={-1}
              title="Fill it with a constant or the clock, or ignore it (f)"
              onClick={() => props.onFill({ node: row.node, port: row.path })}
            >
              fill…
            </button>
          )}
        </span>
      </span>
    </div>
  );
}
