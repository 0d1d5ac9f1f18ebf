import { useEffect, useState } from "react";
import "./operate.css";
import { Fault, Quiet } from "../panels/base/parts";
import { Alarms } from "./Alarms";
import { Commands } from "./Commands";
import { Components } from "./Components";
import { Journal } from "./Journal";
import { operate, useOperating } from "./mode";
import { StopButton } from "./StopButton";
import { open, ownName, rename, useUnit } from "./unit";
import { ValuesPanel } from "./Values";

/** The operator unit; its stop stays while models are looked at. */
export default function Operate() {
  const isOpen = useOperating((mode) => mode.isOpen);
  useEffect(open, []);
  return (
    <>
      <StopButton />
      {isOpen && <Room />}
    </>
  );
}

function Room() {
  const link = useUnit((unit) => unit.link);
  const refusal = useUnit((unit) => unit.refusal);
  const fault = useUnit((unit) => unit.state?.fault ?? "");
  const chosen = useUnit((unit) => unit.chosen);
  return (
    <section className="operate" aria-label="Operate">
      <header>
        <button type="button" onClick={() => operate(false)}>
          ← Models
        </button>
        <h1>Operate</h1>
        <Who />
        <Said />
      </header>
      {link !== "open" && (
        <Fault>{refusal || "There is no connection to the server: nothing here is current."}</Fault>
      )}
      <Fault>{fault}</Fault>
      <Alarms />
      <div className="operate-columns">
        <div>
          <Components />
          {chosen ? <Commands key={chosen} /> : <Quiet>Choose a component.</Quiet>}
        </div>
        <div>
          <ValuesPanel />
          <Journal />
        </div>
      </div>
    </section>
  );
}

/** Who commands, and whether this page may. */
function Who() {
  const commander = useUnit((unit) => unit.state?.commander ?? null);
  const page = useUnit((unit) => unit.page);
  const own = useUnit((unit) => unit.state?.own ?? "");
  const mayCommand = useUnit((unit) => unit.mayCommand);
  const canCommand = useUnit((unit) => unit.canCommand);
  const noRight = useUnit((unit) => unit.noRight);
  const [name, setName] = useState(ownName);
  return (
    <>
      {own && <span className="badge">JAUS id {own}</span>}
      <strong>
        {commander === null
          ? "Nobody commands"
          : commander.page === page
            ? "You command"
            : `${commander.name} commands`}
      </strong>
      {mayCommand ? (
        <label>
          Your name
          <input
            value={name}
            maxLength={40}
            size={12}
            onChange={(event) => setName(event.currentTarget.value)}
            onBlur={() => void rename(name)}
          />
        </label>
      ) : (
        <span className="quiet">
          {noRight ||
            (canCommand
              ? "This page may look, and not command."
              : "This studio only watches: it was started without --operate.")}
        </span>
      )}
    </>
  );
}

function Said() {
  const said = useUnit((unit) => unit.said);
  return (
    <>
      <output className="operate-said" aria-live="polite">
        {said.isError ? "" : said.text}
      </output>
      <span role="alert" className="operate-fault">
        {said.isError ? said.text : ""}
      </span>
    </>
  );
}
