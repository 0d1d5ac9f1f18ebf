import type { LiveComponent, LiveMachine } from "../../protocol";
import { figure, Head } from "../base/parts";

/** The state machines of components that tell them: where each is, and its times. */
export function Machines({ components }: { components: LiveComponent[] }) {
  const machines = components.flatMap((owner) =>
    (owner.machines ?? []).map((machine) => ({ owner, machine })),
  );
  if (machines.length === 0) return null;
  return (
    <table>
      <caption>State machines</caption>
      <Head columns={["component", "machine", "state", "in it for", "share of time"]} />
      <tbody>
        {machines.map(({ owner, machine }) => (
          <tr key={`${owner.id} ${machine.service} ${machine.machine}`}>
            <th scope="row">
              {owner.name || owner.id} <small className="quiet">{owner.id}</small>
            </th>
            <td title={machine.service}>
              {last(machine.service, ":", 1)} {machine.machine}
            </td>
            <td title={machine.state ?? ""}>
              {machine.state ? last(machine.state, ".", 2) : "–"}
              {machine.state && !machine.known && " (unknown to the model)"}
            </td>
            <td className="number">{figure(machine.seconds, "s")}</td>
            <td title={machine.times.map((time) => time.state).join("\n")}>{shares(machine)}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

/** States with their shares of the time, and how often they were entered. */
export function shares({ times }: LiveMachine): string {
  const total = times.reduce((sum, time) => sum + time.seconds, 0);
  const states = times.map(({ state, entries, seconds }) => {
    const share = total > 0 ? ` ${Math.round((100 * seconds) / total)} %` : "";
    return `${last(state, ".", 2)}${share} (${entries}×)`;
  });
  return states.join(", ") || "–";
}

/** The last names of a path. */
function last(path: string, mark: string, count: number): string {
  return path.split(mark).slice(-count).join(mark);
}
