import { useCallback, useMemo, useState } from "react";
import uPlot from "uplot";
import { ask } from "../../actions";
import { TimePlot } from "../../operate/TimePlot";
import type { ComparedRow, ComparedSide, Mark, ReadRecording } from "../../protocol";
import { useStudio } from "../../store";
import { Fault, figure, Quiet } from "../base/parts";
import { useAnswer } from "../base/useAnswer";
import { goTo, nextMark, openBeside, put, usePlayer } from "./player";
import { TimeLine } from "./TimeLine";

const EVENTS: [Mark["kind"], string][] = [
  ["drop", "their first drops"],
  ["state", "their first changes of state"],
  ["control", "their first changes of control"],
];

/** A second recording beside the first, locked to it: what differs, and one number of both. */
export function Beside({ files }: { files: string[] }) {
  const { name, beside, read, besideRead, at, ahead } = usePlayer();
  return (
    <section className="beside" aria-label="Another recording beside it">
      <header>
        <label>
          Beside it
          <select value={beside} onChange={(event) => void openBeside(event.currentTarget.value)}>
            <option value="">nothing</option>
            {files.map((each) => (
              <option key={each}>{each}</option>
            ))}
          </select>
        </label>
        {read && besideRead && <Lock read={read} beside={besideRead} />}
      </header>
      {read && besideRead && (
        <>
          <TimeLine
            label={`Moment of ${beside}, beside`}
            read={besideRead}
            at={Math.min(Math.max(0, at + ahead), besideRead.duration)}
            onAt={(moment) => goTo(moment - ahead)}
          />
          <Differences />
          <BothPlotted key={`${name} ${beside}`} read={read} beside={besideRead} />
        </>
      )}
    </section>
  );
}

/** By what the two are locked. */
function Lock({ read, beside }: { read: ReadRecording; beside: ReadRecording }) {
  const ahead = usePlayer((player) => player.ahead);
  function lock(kind: string) {
    if (kind === "start") return put({ ahead: 0 });
    const [one, other] = [read, beside].map((each) =>
      nextMark(each.marks, kind as Mark["kind"], -1, 1),
    );
    if (one && other) put({ ahead: other.time - one.time });
  }
  const has = (kind: Mark["kind"]) =>
    [read, beside].every((each) => each.marks.some((mark) => mark.kind === kind));
  return (
    <>
      <label>
        Locked by
        <select defaultValue="start" onChange={(event) => lock(event.currentTarget.value)}>
          <option value="start">the time since the start</option>
          {EVENTS.map(([kind, words]) => (
            <option key={kind} value={kind} disabled={!has(kind)}>
              {words}
            </option>
          ))}
        </select>
      </label>
      <span className="quiet">
        the other is at {ahead >= 0 ? "+" : "−"}
        {Math.abs(ahead).toFixed(2)} s
      </span>
    </>
  );
}

function Differences() {
  const { name, beside, at, ahead } = usePlayer();
  const file = useStudio((studio) => studio.file);
  const params = { file, recording: name, at, other: beside, other_at: at + ahead };
  const subject = `${file} ${name} ${beside}`;
  const { value, error } = useAnswer("recording.compare", params, 0, subject);
  if (!value) return <Fault>{error}</Fault>;
  const count = value.rows.filter((each) => each.differing.length > 0).length;
  return (
    <table>
      <caption>
        {count} of {value.rows.length} connections differ at this moment
      </caption>
      <thead>
        <tr>
          <th scope="col">connection</th>
          <th scope="col">rate</th>
          <th scope="col">beside</th>
          <th scope="col">drops</th>
          <th scope="col">beside</th>
          <th scope="col">state</th>
          <th scope="col">beside</th>
        </tr>
      </thead>
      <tbody>
        {value.rows.map((each) => (
          <Row key={`${each.bridge} ${each.connection}`} row={each} />
        ))}
      </tbody>
    </table>
  );
}

const CELLS: [keyof ComparedSide, (side: ComparedSide) => string][] = [
  ["rate", ({ rate }) => figure(rate, "Hz")],
  ["drops", ({ drops }) => (drops === null ? "–" : String(drops))],
  ["state", ({ state }) => state],
];

function Row({ row }: { row: ComparedRow }) {
  const { differing, sides } = row;
  return (
    <tr className={differing.length ? "differs" : ""}>
      <th scope="row">
        {row.bridge}/{row.connection}
      </th>
      {CELLS.flatMap(([name, text]) =>
        sides.map((side, at) => (
          // biome-ignore lint/suspicious/noArrayIndexKey: there are two sides, always
          <td key={`${name} ${at}`}>
            {at === 1 && differing.includes(name) && (
              <span className="level-warning" role="img" aria-label="differs">
                ≠{" "}
              </span>
            )}
            {text(side)}
          </td>
        )),
      )}
    </tr>
  );
}

/** One number of a topic of both, over the time of the first. */
function BothPlotted({ read, beside }: { read: ReadRecording; beside: ReadRecording }) {
  const { name, beside: other, ahead } = usePlayer();
  const [topic, setTopic] = useState("");
  const [path, setPath] = useState("");
  const topics = Object.keys(read.topics).filter((each) => each in beside.topics);
  const { value, error } = useAnswer(
    "recording.numbers",
    topic ? { recording: name, topic } : null,
  );
  const { duration } = read;
  const look = useCallback(
    async (points: number) => {
      const asked = [
        { recording: name, start: -1, end: duration },
        { recording: other, start: ahead - 1, end: duration + ahead },
      ];
      const found = await Promise.all(
        asked.map((each) => ask("recording.series", { ...each, topic, path, points })),
      );
      const [first, second] = found as [(typeof found)[0], (typeof found)[0]];
      return uPlot.join([
        [first.times, first.values],
        [second.times.map((time) => time - ahead), second.values],
      ]);
    },
    [name, other, topic, path, duration, ahead],
  );
  const range = useCallback((): [number, number] => [0, duration], [duration]);
  const lines = useMemo(
    () => [
      { label: name, colour: "--chosen" },
      { label: other, colour: "--error" },
    ],
    [name, other],
  );
  return (
    <>
      <div className="choices">
        <label>
          Plot of
          <select
            value={topic}
            onChange={(event) => {
              setTopic(event.currentTarget.value);
              setPath("");
            }}
          >
            <option value="">choose a topic…</option>
            {topics.map((each) => (
              <option key={each}>{each}</option>
            ))}
          </select>
        </label>
        {topic && (
          <label>
            its number
            <select value={path} onChange={(event) => setPath(event.currentTarget.value)}>
              <option value="">choose…</option>
              {value?.paths.map((each) => (
                <option key={each}>{each}</option>
              ))}
            </select>
          </label>
        )}
      </div>
      <Fault>{error}</Fault>
      {topics.length === 0 && <Quiet>The two have no topic in common.</Quiet>}
      {path && (
        <TimePlot
          title={`${path} of ${topic}`}
          caption={`${path} of ${topic}: ${name} blue, ${other} orange`}
          lines={lines}
          range={range}
          look={look}
        />
      )}
    </>
  );
}
