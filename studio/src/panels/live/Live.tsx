import { type ReactNode, useEffect, useState } from "react";
import { ask } from "../../actions";
import { useTrying } from "../../answers";
import type { LiveComponent, LiveConnection } from "../../protocol";
import { partOf } from "../../selection";
import { active, type Studio, state, update, useStudio } from "../../store";
import { Fault, figure, Head, Level, Quiet } from "../base/parts";
import { useAnswer } from "../base/useAnswer";
import { Machines } from "./Machines";

const LOOK_MS = 1000;
/** Seconds without a word of the server, which speaks once a second, after which all is old. */
const OLD_S = 4;

/** What the running system says of itself: its connections, its components, and the last messages. */
export function Live() {
  const file = useStudio((studio) => studio.file);
  const live = useStudio((studio) => studio.live);
  const recorded = useStudio((studio) => studio.recorded);
  const [fault, attempt] = useTrying();
  const [isStarting, setStarting] = useState(false);
  const [open, setOpen] = useState("");
  const chosen = useStudio(chosenRow);
  useEffect(() => {
    if (chosen) setOpen(chosen);
  }, [chosen]);

  async function turn(isOn: boolean) {
    setStarting(true);
    await attempt(async () => {
      await (isOn ? ask("live.start", { file }) : ask("live.stop", {}));
      // The first state comes a moment later.
      const begun = { live: state().live ?? { edges: {}, boxes: {} }, liveAt: performance.now() };
      update(isOn ? begun : { live: null, liveAt: 0 });
    });
    setStarting(false);
  }

  if (recorded)
    return (
      <Quiet>The diagram shows the recording {recorded}: close that to watch what runs.</Quiet>
    );
  return (
    <section className="live" aria-label="Live">
      <header className="bar">
        <button
          type="button"
          className="best"
          disabled={!file || isStarting}
          onClick={() => turn(live === null)}
        >
          {live === null ? "Watch" : "Stop watching"}
        </button>
        {live === null ? (
          <span className="quiet">
            Listens to /diagnostics and asks JAUS components as an observer; it takes no control.
          </span>
        ) : (
          <>
            <strong>{live.health ?? ""}</strong>
            <Old />
            {Object.entries(live.sources ?? {}).map(([name, said]) => (
              <span key={name} className="badge">
                {name}: {said}
              </span>
            ))}
          </>
        )}
      </header>
      <Fault>{fault}</Fault>
      {live !== null && (
        <>
          <Connections
            connections={live.connections ?? []}
            open={open}
            onOpen={setOpen}
            details={(row) => <LastMessage row={row} />}
          />
          <Components components={live.components ?? []} />
          <Machines components={live.components ?? []} />
        </>
      )}
    </section>
  );
}

/** The connection that is chosen in the diagram, by its row or a line of that; empty for none. */
function chosenRow(studio: Studio): string {
  const key = active(studio);
  if (!key) return "";
  const { id } = partOf(key);
  const isOf = ({ row }: LiveConnection) => row !== "" && (id === row || id.startsWith(`${row}!`));
  const connection = studio.live?.connections?.find(isOf);
  return connection ? nameOf(connection) : "";
}

const nameOf = ({ bridge, connection }: LiveConnection) => `${bridge}/${connection}`;

/** Says of what time the values are as soon as no new ones come. */
function Old() {
  const at = useStudio((state) => state.liveAt);
  const isLost = useStudio((state) => state.link !== "open");
  const [now, setNow] = useState(() => performance.now());
  useEffect(() => {
    const timer = setInterval(() => setNow(performance.now()), LOOK_MS);
    return () => clearInterval(timer);
  }, []);
  const seconds = Math.floor((now - at) / 1000);
  if (at === 0 || (seconds < OLD_S && !isLost)) return null;
  return (
    <span className="badge" role="alert">
      ✝ stale: nothing was told for {Math.max(seconds, 0)} s
    </span>
  );
}

/** Names with their counts: `late 3, invalid 1`; those of nothing are left out. */
export function counted(counts: Record<string, number>): string {
  const drops = Object.entries(counts).filter(([, count]) => count > 0);
  return drops.length === 0 ? "–" : drops.map(([name, count]) => `${name} ${count}`).join(", ");
}

/** A rate beside what was declared. */
export function rates(connection: Pick<LiveConnection, "rate" | "declared_rate">): string {
  const declared = connection.declared_rate ? ` of ${figure(connection.declared_rate)}` : "";
  return `${figure(connection.rate)}${declared} Hz`;
}

interface ConnectionsProps {
  connections: LiveConnection[];
  open: string;
  onOpen: (name: string) => void;
  /** What stands below the connection that is open. */
  details?: (row: string) => ReactNode;
}

/** A table of connections, of which one can be opened. */
export function Connections({ connections, open, onOpen, details }: ConnectionsProps) {
  if (connections.length === 0) return <Quiet>No bridge has told anything yet.</Quiet>;
  return (
    <table>
      <caption>Connections</caption>
      <Head columns={["connection", "state", "rate", "age", "latency", "drops"]} />
      {connections.map((connection) => {
        const name = nameOf(connection);
        const isOpen = open === name;
        return (
          <tbody key={name}>
            <tr>
              <th scope="row">
                <button
                  type="button"
                  className="link"
                  aria-expanded={isOpen}
                  onClick={() => onOpen(isOpen ? "" : name)}
                >
                  {name}
                </button>
              </th>
              <td title={connection.reason}>
                <Level level={connection.level} /> {connection.reason}
              </td>
              <td className="number">{rates(connection)}</td>
              <td className="number">{figure(connection.age, "s")}</td>
              <td className="number">{latency(connection.latency_us)}</td>
              <td>{counted(connection.drops)}</td>
            </tr>
            {isOpen && details && (
              <tr>
                <td colSpan={6}>{details(connection.row)}</td>
              </tr>
            )}
          </tbody>
        );
      })}
    </table>
  );
}

function latency(microseconds: Record<string, number>): string {
  const durations = Object.entries(microseconds);
  return durations.length === 0
    ? "–"
    : durations.map(([name, value]) => `${name} ${figure(value, "µs")}`).join(", ");
}

/** The last message of a connection on both sides, as long as it is open. */
function LastMessage({ row }: { row: string }) {
  const [turn, setTurn] = useState(0);
  useEffect(() => {
    const timer = setInterval(() => setTurn((before) => before + 1), LOOK_MS);
    return () => clearInterval(timer);
  }, []);
  const { value, error } = useAnswer("live.message", row ? { connection: row } : null, turn);
  if (row === "") return <Quiet>The model has no such connection.</Quiet>;
  if (error) return <Fault>{error}</Fault>;
  if (value === null) return <Quiet>Waiting for a message…</Quiet>;
  return (
    <div className="last-message">
      <span className="quiet">
        {value.age === null ? "no message yet" : `${figure(value.age, "s")} ago`}
      </span>
      <div>
        <h2>JAUS</h2>
        <pre>{value.jaus}</pre>
      </div>
      <div>
        <h2>ROS</h2>
        <pre>{value.ros}</pre>
      </div>
    </div>
  );
}

/** A table of components. */
export function Components({ components }: { components: LiveComponent[] }) {
  if (components.length === 0) return null;
  return (
    <table>
      <caption>Components</caption>
      <Head
        columns={["component", "level", "state", "controlled by", "round trip", "last answer"]}
      />
      <tbody>
        {components.map((component) => (
          <tr key={component.id}>
            <th scope="row">
              {component.name || component.id} <small className="quiet">{component.id}</small>
            </th>
            <td title={component.reason}>
              <Level level={component.level} /> {component.level === "ok" ? "" : component.reason}
            </td>
            <td>{component.state ?? "–"}</td>
            <td>{component.controller || "–"}</td>
            <td className="number">{figure(component.round_trip_ms, "ms")}</td>
            <td className="number">{figure(component.told ?? null, "s")}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}
