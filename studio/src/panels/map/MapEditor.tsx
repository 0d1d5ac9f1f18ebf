import { type KeyboardEvent, useMemo, useState } from "react";
import { choose, connect, remove } from "../../actions";
import type { GraphEnd } from "../../protocol";
import { useRevision, useStudio } from "../../store";
import { Quiet, Select } from "../base/parts";
import { useAnswer } from "../base/useAnswer";
import { Fill } from "./Fill";
import { MemberTree } from "./MemberTree";
import { type Filter, sides } from "./rows";
import { TryIt } from "./TryIt";

const FILTERS: [Filter, string][] = [
  ["all", "all members"],
  ["mapped", "mapped members"],
  ["unmapped", "unmapped members"],
];

/** An attribute map: all members of both ends, what fills them, and what they give when tried. */
export function MapEditor() {
  const file = useStudio((studio) => studio.file);
  const view = useStudio((studio) => studio.view);
  const element = useStudio((studio) => studio.chosen);
  const revision = useRevision();
  const isMap = view.startsWith("map:");
  const question = isMap ? { file, view } : null;
  const graph = useStudio((state) => state.graph);
  const { value: members } = useAnswer("members", question, revision);
  const [query, setQuery] = useState("");
  const [filter, setFilter] = useState<Filter>("all");
  const [filled, setFilled] = useState<GraphEnd | null>(null);
  const [begun, setBegun] = useState<GraphEnd | null>(null);

  const ends = useMemo(() => (graph ? sides(graph, members?.sides ?? []) : []), [graph, members]);

  if (!isMap) return <Quiet>Open the view of a map to edit its assignments.</Quiet>;
  if (!graph) return <Quiet>Reading…</Quiet>;

  function onKeyDown(event: KeyboardEvent) {
    if (event.key !== "Escape" || begun === null) return;
    event.stopPropagation();
    setBegun(null);
  }

  const tree = (side: (typeof ends)[number]) => (
    <MemberTree
      key={`${view} ${side.node}`}
      side={side}
      query={query}
      filter={filter}
      begun={begun}
      chosen={element}
      onBegin={setBegun}
      onConnect={connect}
      onFill={setFilled}
      onChoose={choose}
      onRemove={(use, label) => remove([use], label)}
    />
  );

  return (
    <section className="map-editor" aria-label="Map" onKeyDown={onKeyDown}>
      <header className="bar">
        <input
          type="search"
          aria-label="Filter members"
          placeholder="Filter members"
          value={query}
          onChange={(event) => setQuery(event.currentTarget.value)}
        />
        <Select
          label="Members shown"
          value={filter}
          options={FILTERS}
          onChoose={(chosen) => setFilter(chosen as Filter)}
        />
        <span className="quiet" role="status">
          {begun
            ? `From ${begun.port}: choose where it goes, or press Esc.`
            : "Drag a member onto one of the other side, or press c on both; f fills one with a constant."}
        </span>
      </header>
      {filled && (
        <Fill
          key={`${filled.node} ${filled.port}`}
          file={file}
          view={view}
          target={filled}
          revision={revision}
          onDone={() => setFilled(null)}
        />
      )}
      <div className="map-sides">
        <div>{ends.filter((end) => end.side === "jaus").map(tree)}</div>
        <div>{ends.filter((end) => end.side === "ros").map(tree)}</div>
      </div>
      <TryIt key={view} file={file} map={view.slice("map:".length)} revision={revision} />
    </section>
  );
}
