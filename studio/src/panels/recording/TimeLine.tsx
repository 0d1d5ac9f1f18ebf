import type { KeyboardEvent } from "react";
import type { Mark, ReadRecording } from "../../protocol";

const STEP_S = 1;
const PAGE_S = 10;
const FINE_S = 0.1;
const KINDS: [Mark["kind"], string][] = [
  ["drop", "drops"],
  ["state", "states"],
  ["control", "controllers"],
];
/** Marks are drawn to the thousandth of the line. */
const PLACES = 1000;

interface Props {
  label: string;
  read: ReadRecording;
  at: number;
  onAt: (at: number) => void;
}

/** A moment in seconds, which is chosen with the mouse and the keys; above it what changed when. */
export function TimeLine({ label, read, at, onAt }: Props) {
  function onKeyDown(event: KeyboardEvent) {
    const step = event.shiftKey ? FINE_S : STEP_S;
    const to = {
      ArrowLeft: at - step,
      ArrowDown: at - step,
      ArrowRight: at + step,
      ArrowUp: at + step,
      PageDown: at - PAGE_S,
      PageUp: at + PAGE_S,
      Home: 0,
      End: read.duration,
    }[event.key];
    if (to === undefined || event.altKey || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    onAt(Math.min(Math.max(0, to), read.duration));
  }

  const count = (kind: Mark["kind"]) => read.marks.filter((mark) => mark.kind === kind).length;
  const title = `Marks: ${KINDS.map(([kind, words]) => `${words} ${count(kind)}`).join(", ")}`;
  return (
    <div className="time-line">
      <svg viewBox={`0 0 ${PLACES} 12`} preserveAspectRatio="none" role="img" aria-label={title}>
        {KINDS.map(([kind], row) => (
          <path key={kind} className={`mark-${kind}`} d={ticks(read, kind, row * 4)} />
        ))}
      </svg>
      <input
        type="range"
        aria-label={label}
        min={0}
        max={read.duration}
        step={0.01}
        value={at}
        aria-valuetext={`${at.toFixed(1)} of ${read.duration.toFixed(1)} seconds`}
        onKeyDown={onKeyDown}
        onChange={(event) => onAt(Number(event.currentTarget.value))}
      />
      <output>
        {at.toFixed(2)} of {read.duration.toFixed(1)} s
      </output>
      <small className="quiet">{title}</small>
    </div>
  );
}

/** One tick for all marks of a place. */
function ticks({ marks, duration }: ReadRecording, kind: Mark["kind"], y: number): string {
  const places = new Set<number>();
  for (const mark of marks) {
    if (mark.kind === kind) places.add(duration ? Math.round((mark.time / duration) * PLACES) : 0);
  }
  return [...places].map((x) => `M${x} ${y}v4`).join("");
}
