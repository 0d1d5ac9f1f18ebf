import { useState } from "react";
import { edit } from "../actions";
import { useSettled } from "../answers";
import { Fault, Head, Quiet, Select } from "../panels/base/parts";
import { useAnswer } from "../panels/base/useAnswer";
import type { Partition as Plan, PlannedBridge } from "../protocol";
import { useStudio } from "../store";
import { Modal } from "./Modal";

const PAUSE_MS = 300;

/** The bridges before and after a proposal, which may be changed and taken. */
export function Partition({ onClose }: { onClose(): void }) {
  const file = useStudio((studio) => studio.file);
  const revision = useStudio((studio) => studio.revision);
  const [most, setMost] = useState("");
  const [load, setLoad] = useState("50");
  const [names, setNames] = useState<Record<string, string> | null>(null);
  const limits = useSettled(`${Number(most) || 0} ${Number(load) || 50}`, PAUSE_MS);
  const [atMost = 0, atLoad = 50] = limits.split(" ").map(Number);
  const asked = { file, most: Math.round(atMost), load: atLoad, ...(names && { names }) };
  const { value: plan, error, isPending } = useAnswer("partition", asked, revision, file);
  const isTaken = isPending || !plan?.commands.length;

  function onTake() {
    if (!plan || isTaken) return;
    onClose();
    void edit(plan.commands, "Partition the bridges", plan.revision);
  }

  return (
    <Modal title="Which bridge carries what" onClose={onClose} isWide>
      <div className="bar">
        <Limit label="Connections at most" value={most} onChange={setMost} />
        <Limit label="CPU % at most" value={load} onChange={setLoad} />
        {names && (
          <button type="button" onClick={() => setNames(null)}>
            Propose again
          </button>
        )}
        {isPending && <span className="quiet">weighing…</span>}
      </div>
      <Fault>{error || plan?.faults.join("; ") || ""}</Fault>
      {plan && (
        <>
          <Figures plan={plan} />
          {plan.excess.length > 0 && <p role="alert">Not held: {plan.excess.join("; ")}</p>}
          <Carried
            plan={plan}
            onMove={(connection, to) => setNames({ ...homesOf(plan), ...names, [connection]: to })}
          />
        </>
      )}
      {!plan && !error && <Quiet>Weighing…</Quiet>}
      <footer>
        <button type="button" onClick={onClose}>
          Keep it
        </button>
        <button type="button" className="best" aria-disabled={isTaken} onClick={onTake}>
          {plan && !plan.faults.length && !plan.commands.length ? "Nothing to change" : "Take it"}
        </button>
      </footer>
    </Modal>
  );
}

function homesOf(plan: Plan): Record<string, string> {
  return Object.fromEntries(
    plan.after.flatMap(({ name, connections }) =>
      connections.map((connection) => [connection, name]),
    ),
  );
}

interface LimitProps {
  label: string;
  value: string;
  onChange(text: string): void;
}

function Limit({ label, value, onChange }: LimitProps) {
  return (
    <label>
      {label}{" "}
      <input
        inputMode="decimal"
        size={5}
        value={value}
        onChange={(event) => onChange(event.currentTarget.value)}
      />
    </label>
  );
}

const COLUMNS = [
  "bridge",
  "host",
  "connections",
  "CPU %",
  "datagrams/s",
  "kB/s to hosts",
  "wait ms",
] as const;

function Figures({ plan }: { plan: Plan }) {
  return (
    <table className="figures">
      <Head columns={COLUMNS} />
      {(["before", "after"] as const).map((when) => (
        <tbody key={when}>
          <tr>
            <th colSpan={7}>{when}</th>
          </tr>
          {plan[when].map((bridge) => (
            <tr key={bridge.name}>
              <td>{bridge.name}</td>
              <td>{bridge.host}</td>
              {figuresOf(bridge).map(([name, text]) => (
                <td key={name}>{text}</td>
              ))}
            </tr>
          ))}
        </tbody>
      ))}
    </table>
  );
}

function figuresOf(bridge: PlannedBridge): [string, string][] {
  return [
    ["connections", `${bridge.connections.length}`],
    ["load", (bridge.processor_share * 100).toFixed(2)],
    ["datagrams", bridge.datagrams_per_s.toFixed(0)],
    ["bytes", (bridge.bytes_between_hosts_per_s / 1000).toFixed(1)],
    ["wait", (bridge.wait_s * 1000).toFixed(2)],
  ];
}

interface CarriedProps {
  plan: Plan;
  onMove(connection: string, to: string): void;
}

/** The connections of each bridge, with what moves each to another one. */
function Carried({ plan, onMove }: CarriedProps) {
  const homes = [...new Set([...plan.before, ...plan.after].map(({ name }) => name))];
  const free = (n: number): string => (homes.includes(`bridge_${n}`) ? free(n + 1) : `bridge_${n}`);
  return plan.after.map(({ name, connections, reasons }) => (
    <details key={name} open={plan.after.length < 5}>
      <summary>
        {name} <span className="quiet">{reasons.join("; ")}</span>
      </summary>
      <ul className="carried">
        {connections.map((connection) => (
          <li key={connection}>
            <label>
              {connection}
              {plan.moved[connection] && <em> moves</em>}{" "}
              <Select
                label={connection}
                value={name}
                options={[
                  ...homes.map((home) => [home, home] as const),
                  [free(1), `new: ${free(1)}`],
                ]}
                onChoose={(home) => onMove(connection, home)}
              />
            </label>
          </li>
        ))}
      </ul>
    </details>
  ));
}
