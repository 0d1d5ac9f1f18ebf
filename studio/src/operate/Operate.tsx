import { useState } from "react";
import { Quiet } from "../panels/base/parts";
import { Alarms, Requests } from "./Alarms";
import { Commands } from "./Commands";
import { Components } from "./Components";
import { Journal } from "./Journal";
import { DOCK } from "./StickPad";
import { StopButton } from "./StopButton";
import { ownName, rename, useUnit } from "./unit";
import { ValuesPanel } from "./Values";

/** The operator unit. Each part has a fixed place; what is longer scrolls within its own. */
export function Operate() {
  const chosen = useUnit((unit) => unit.chosen);
  const isStale = useUnit((unit) => unit.isStale);
  return (
    <div className={isStale ? "operate stale" : "operate"}>
      <header>
        <h1>Operate</h1>
        <Who />
        <Notice />
      </header>
      <Alarms />
      <Requests />
      <main>
        <Components />
        <section className="commands" aria-label="Commands">
          {chosen ? <Commands key={chosen} /> : <Quiet>Choose a component.</Quiet>}
        </section>
        <ValuesPanel />
        <Journal />
      </main>
      <div className="dock">
        <div id={DOCK} className="dock-pad" />
        <Said />
        <StopButton />
      </div>
    </div>
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
  const isKnown = useUnit((unit) => unit.state !== null && !unit.isStale);
  const [name, setName] = useState(ownName);
  const who =
    commander === null
      ? "Nobody commands"
      : commander.page === page
        ? "You command"
        : `${commander.name} commands`;
  return (
    <>
      {own && <span className="badge">JAUS id {own}</span>}
      {isKnown && <span className="badge">times in {new Date().toTimeString().slice(9, 17)}</span>}
      <strong>{isKnown ? who : "Who commands is not known"}</strong>
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
            (isKnown &&
              (canCommand
                ? "This page may look, and not command."
                : "This unit only watches: it was started without --stop-all."))}
        </span>
      )}
    </>
  );
}

/** How old all of this is, and what is wrong with the unit itself. */
function Notice() {
  const link = useUnit((unit) => unit.link);
  const refusal = useUnit((unit) => unit.refusal);
  const silence = useUnit((unit) => unit.silence);
  const isStale = useUnit((unit) => unit.isStale);
  const fault = useUnit((unit) => unit.state?.fault ?? "");
  const unread = useUnit((unit) => unit.state?.unread ?? "");
  const unguarded = useUnit((unit) => unit.state?.unguarded ?? "");
  const lost = refusal || (link === "lost" && "There is no connection to the unit.");
  const old = `✝ No word from the unit for ${silence.toFixed(1)} s: nothing here is current.`;
  const known = [fault, unread && `Models: ${unread}`, unguarded && `The guardian ${unguarded}`];
  return (
    <span className="notice" role="alert">
      {[lost, ...(isStale ? [!refusal && old] : known)].filter(Boolean).join(" · ")}
    </span>
  );
}

function Said() {
  const said = useUnit((unit) => unit.said);
  return (
    <div className="said">
      <output aria-live="polite">{said.isError ? "" : said.text}</output>
      <span role="alert" className="fault">
        {said.isError ? `✖ ${said.text}` : ""}
      </span>
    </div>
  );
}
