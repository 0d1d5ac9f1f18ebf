import { lazy, Suspense, useState } from "react";
import { Fault, Quiet } from "../panels/base/parts";
import { driversOf } from "./drawing";
import { FieldsForm } from "./FieldsForm";
import { type Draft, type Faults, readGroup } from "./fields";
import type { Command } from "./protocol";
import { StickPad } from "./StickPad";
import { commands, nameOf, tell, tried, unit, useAnswer, useUnit } from "./unit";

const Drawing = lazy(() => import("./Drawing"));

/** The commands of the chosen component, each as a form of its definition. */
export function Commands() {
  const component = useUnit((unit) => unit.chosen);
  const [chosen, setChosen] = useState("");
  const learnt = useUnit((unit) => unit.learnt);
  const { value, error, again } = useAnswer("messages", { component }, learnt);
  const offered = value?.commands ?? [];
  const isSilent = value !== null && offered.length === 0;
  const command = offered.find((candidate) => candidate.name === chosen);
  const drivers = driversOf(
    value?.services ?? [],
    offered.map((candidate) => candidate.name),
  );
  return (
    <>
      <h2>Commands of {nameOf(component)}</h2>
      <Fault>{error}</Fault>
      {isSilent && <Quiet>It says of no service that it provides it.</Quiet>}
      {(error || isSilent) && (
        <button type="button" onClick={again}>
          Ask again
        </button>
      )}
      {offered.length > 0 && (
        <label>
          Command
          <select
            aria-label="Command"
            value={chosen}
            onChange={(event) => setChosen(event.currentTarget.value)}
          >
            <option value="">choose…</option>
            {groupsOf(offered).map(([service, group]) => (
              <optgroup key={service} label={service}>
                {group.map((candidate) => (
                  <option key={candidate.name}>{candidate.name}</option>
                ))}
              </optgroup>
            ))}
          </select>
        </label>
      )}
      {command && <CommandForm key={command.name} command={command} component={component} />}
      {drivers.length > 0 && (
        <Suspense fallback={null}>
          <Drawing component={component} drivers={drivers} />
        </Suspense>
      )}
    </>
  );
}

const CORE = ["AccessControl", "Discovery", "Events", "Liveness", "Management", "Transport"];

/** Commands by their services; those of the core, which operate nothing, come last. */
function groupsOf(offered: Command[]): [string, Command[]][] {
  const services = [...new Set(offered.map((command) => command.service))];
  const isCore = (service: string) => Number(CORE.includes(service));
  return services
    .sort((one, other) => isCore(one) - isCore(other) || one.localeCompare(other))
    .map((service) => [service, offered.filter((command) => command.service === service)]);
}

function CommandForm({ command, component }: { command: Command; component: string }) {
  const [draft, setDraft] = useState<Draft>({});
  const [isTried, setTried] = useState(false);
  const [answer, setAnswer] = useState("");
  const isOurs = useUnit(commands);
  const isHeld = useUnit((unit) => unit.state?.holds.some((hold) => hold.component === component));
  const { value: form, error } = useAnswer("form", { component, message: command.name });
  if (form === null) return <Fault>{error}</Fault>;
  const { fields } = form;
  const faults: Faults = new Map();
  const value = readGroup(fields, draft, "", faults);

  async function send() {
    setTried(true);
    setAnswer("");
    if (faults.size > 0) {
      tell(`${command.name} is not sent: ${faults.size} field(s) are wrong.`, true);
      return;
    }
    const done = await tried("send", { component, message: command.name, fields: value });
    if (done) setAnswer(done.answer);
    else if (unit().said.isError) setAnswer("");
  }

  return (
    <form
      className="command"
      noValidate
      onSubmit={(event) => {
        event.preventDefault();
        void send();
      }}
    >
      {command.documentation && <p className="quiet">{command.documentation}</p>}
      <FieldsForm
        fields={fields}
        draft={draft}
        faults={faults}
        isTried={isTried}
        onDraft={setDraft}
      />
      <button type="submit" className="best" disabled={!isOurs}>
        Send {command.name}
      </button>
      <output className="answer">{isOurs ? answer : "Take control of a component first."}</output>
      <StickPad
        command={command}
        component={component}
        fields={fields}
        draft={draft}
        isAllowed={isOurs && isHeld === true}
      />
    </form>
  );
}
