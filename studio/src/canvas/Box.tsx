import { Handle, type NodeProps, Position, useStore } from "@xyflow/react";
import {
  type CSSProperties,
  createContext,
  type DragEvent,
  memo,
  useContext,
  useState,
} from "react";
import { beginRename, CARRIED, carriedBy, rename } from "../actions";
import { NameInput } from "../dialogs/NameInput";
import type { GraphNode, GraphPort } from "../protocol";
import { CLOSED, nodeKey, type PartKey, portKey } from "../selection";
import { active, isPresent, type Studio, update, useStudio } from "../store";
import { type BoxNode, handleId } from "./flow";
import { domId, liveClass, liveText, Mark, severityOf, told } from "./marks";
import { useTurn } from "./turns";

/** Zoom below which no row can be read, and none is drawn. */
const FAR = 0.28;

/** What bridges cost, by the ids of their boxes. */
export const Loads = createContext<Record<string, string>>({});

/** A box with its rows, as large as the server says. */
export const Box = memo(function Box({ data }: NodeProps<BoxNode>) {
  const { node } = data;
  const key = nodeKey(node.id);
  const states = useStudio((studio) => statesOf(studio, node));
  const live = useStudio((studio) => studio.live?.boxes[node.id]);
  const load = useContext(Loads)[node.id];
  const isNow = useStudio((studio) => isPresent(studio, node.id));
  const severity = severityOf(node.findings);
  const renaming = useStudio(({ renaming }) =>
    renaming && [key, ...rowKeys(node)].includes(renaming.key) ? renaming : null,
  );
  const isClosed = node.kind === CLOSED;
  const isNear = useStore((flow) => flow.transform[2] >= FAR);
  const [own = "", ...rows] = states.split(BETWEEN);
  const [wasNear, setWasNear] = useState(false);
  const isDetailed = useTurn(isNear, node.ports.length);
  // A finger is at the box only when it begins to draw.
  const hasOwn = wasNear || (isDetailed && isTouched());
  const hasEnds = (states: string | undefined) => hasOwn || Boolean(states?.includes("legal"));
  const hasRows = isDetailed || rows.some((row) => row.includes("active"));
  return (
    // biome-ignore lint/a11y/useSemanticElements: the diagram is one application with parts
    <div
      id={domId(key)}
      className={`box ${node.kind} ${node.initial ? "initial" : ""} ${severity} ${liveClass(live)} ${isNow ? "now" : ""} ${own}`}
      role="group"
      aria-label={`${labelOf(node)}${node.initial ? ", the initial state" : ""}${isNow ? ", stepped to" : ""}`}
      data-part={key}
      style={isClosed ? closedStyle(node) : { width: node.width, height: node.height }}
      onPointerEnter={() => setWasNear(true)}
    >
      <div className="head" style={{ height: node.head }}>
        <Name partKey={key} text={node.title} className="title" renaming={renaming} />
        <Mark findings={node.findings} />
        {node.subtitle.map((line) => (
          <div key={line} className="subtitle" title={line}>
            {line}
          </div>
        ))}
        {live && isClosed && <div className="live-inside">{liveText(live)}</div>}
      </div>
      {live && !isClosed && (
        <div className="live-text" title={liveText(live)}>
          {liveText(live)}
        </div>
      )}
      {load && !live && (
        <div className="live-text" title="Estimated as jausml report does">
          {load}
        </div>
      )}
      {hasRows &&
        node.ports.map((port, at) => (
          <Row
            key={port.id}
            node={node.id}
            port={port}
            isCarried={node.kind === "bridge" && Boolean(port.element)}
            states={rows[at] ?? ""}
            renaming={renaming?.key === portKey(node.id, port.id) ? renaming : null}
          />
        ))}
      {hasEnds(own) && <Ends port="" y={node.head / 2} isWhole />}
      {hasRows &&
        node.ports.map(
          (port, at) =>
            hasEnds(rows[at]) && <Ends key={port.id} port={port.id} y={port.y + port.height / 2} />,
        )}
    </div>
  );
});

const isTouched = (): boolean => window.matchMedia("(pointer: coarse)").matches;

/** By numbers: containers that the style sheet asks for their size are laid out one by one. */
function closedStyle({ width, height }: GraphNode): CSSProperties {
  const style = { "--width": `${width}px`, "--height": `${height}px` };
  return { width, height, ...style } as CSSProperties;
}

interface RowProps {
  node: string;
  port: GraphPort;
  /** Whether it may be dragged to another bridge. */
  isCarried: boolean;
  states: string;
  renaming: Studio["renaming"];
}

const Row = memo(function Row({ node, port, isCarried, states, renaming }: RowProps) {
  const key = portKey(node, port.id);
  function onDragStart(event: DragEvent) {
    event.dataTransfer.effectAllowed = "move";
    event.dataTransfer.setData(CARRIED, JSON.stringify(carriedBy(key)));
  }
  return (
    // biome-ignore lint/a11y/useSemanticElements: the diagram is one application with parts
    <div
      id={domId(key)}
      draggable={isCarried}
      onDragStart={isCarried ? onDragStart : undefined}
      className={`row ${isCarried ? "nodrag" : ""} ${states} ${/unmapped|unconnected/.test(port.mark) ? "quiet" : ""}`}
      style={{ top: port.y, height: port.height, paddingLeft: 10 + 12 * port.depth }}
      role="group"
      aria-label={[port.label, port.note, port.mark, told(port.findings)]
        .filter(Boolean)
        .join(", ")}
      data-part={key}
      title={port.details.map(([name, text]) => `${name}: ${text}`).join("\n") || undefined}
    >
      <Name partKey={key} text={port.label} className="label" renaming={renaming} />
      {port.note && <span className="note">{port.note}</span>}
      <span className="end">
        {port.mark && <span className="word">{port.mark}</span>}
        <Mark findings={port.findings} />
      </span>
    </div>
  );
});

/**
 * Where a pointer draws lines from, once it has been at the box: each end listens to the whole
 * diagram. Where lines leave and arrive is told by the numbers of `flow.ts`.
 */
function Ends({ port, y, isWhole = false }: { port: string; y: number; isWhole?: boolean }) {
  return (
    <>
      <Handle id={handleId("l", port)} type="source" position={Position.Left} style={{ top: y }} />
      <Handle id={handleId("r", port)} type="source" position={Position.Right} style={{ top: y }} />
      {isWhole && (
        <>
          <Handle id={handleId("t", port)} type="source" position={Position.Top} />
          <Handle id={handleId("b", port)} type="source" position={Position.Bottom} />
        </>
      )}
    </>
  );
}

interface NameProps {
  partKey: PartKey;
  text: string;
  className: string;
  renaming: Studio["renaming"];
}

function Name({ partKey, text, className, renaming }: NameProps) {
  if (renaming?.key === partKey) {
    return (
      <NameInput
        name={renaming.name}
        onDone={(name) => void rename(renaming.element, renaming.name ?? "", name, renaming.base)}
        onCancel={() => update({ renaming: null })}
      />
    );
  }
  return (
    // biome-ignore lint/a11y/noStaticElementInteractions: F2 does the same
    <span className={className} title={text} onDoubleClick={() => void beginRename(partKey)}>
      {text}
    </span>
  );
}

function labelOf(node: GraphNode): string {
  const rows = node.ports.length;
  return [
    `${node.kind} ${node.title}`,
    ...node.subtitle,
    rows ? `${rows} row${rows === 1 ? "" : "s"}` : "",
    told(node.findings),
  ]
    .filter(Boolean)
    .join(", ");
}

const rowKeys = (node: GraphNode) => node.ports.map((port) => portKey(node.id, port.id));

const BETWEEN = "\u001f";

/** Classes of a box and of each of its rows as one text, so that a box is drawn anew only if one changes. */
function statesOf(studio: Studio, node: GraphNode): string {
  const keys = [nodeKey(node.id), ...rowKeys(node)];
  const { selection, bright, legal, under } = studio;
  if (!selection.length && !bright && !legal && !under) return "";
  const here = active(studio);
  return keys
    .map((key) =>
      [
        selection.includes(key) ? "chosen" : "",
        key === here ? "active" : "",
        bright && !bright.has(key) ? "dim" : "",
        legal?.has(key) ? "legal" : "",
        key === under ? "under" : "",
      ]
        .filter(Boolean)
        .join(" "),
    )
    .join(BETWEEN);
}
