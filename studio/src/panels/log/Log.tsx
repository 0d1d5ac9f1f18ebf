import { useState } from "react";
import { redo, undo } from "../../actions";
import { useRevision } from "../../store";
import { clock, Fault, Quiet } from "../base/parts";
import { useAnswer } from "../base/useAnswer";

/** What was done, and how far it is undone: go back to any point of it. */
export function Log() {
  const revision = useRevision();
  const { value, error } = useAnswer("log", {}, revision);
  const [isGoing, setGoing] = useState(false);
  if (error) return <Fault>{error}</Fault>;
  if (value === null) return <Quiet>Reading…</Quiet>;
  const { entries, at } = value;

  /** Undoes or redoes, one after the other, until so many entries are done. */
  async function go(target: number) {
    setGoing(true);
    try {
      for (let done = at; done > target; done--) await undo();
      for (let done = at; done < target; done++) await redo();
    } finally {
      setGoing(false);
    }
  }

  if (entries.length === 0)
    return (
      <section className="log" aria-label="Changes">
        <Quiet>Nothing was changed yet.</Quiet>
        <Faults revision={revision} />
      </section>
    );
  return (
    <section className="log" aria-label="Changes">
      <ol>
        <li className={at === 0 ? "is-now" : ""}>
          <button
            type="button"
            className="link"
            disabled={isGoing || at === 0}
            onClick={() => go(0)}
          >
            As it was opened
          </button>
        </li>
        {entries.map((entry, index) => (
          <li
            key={entry.number}
            className={index >= at ? "is-undone" : index === at - 1 ? "is-now" : ""}
            aria-current={index === at - 1 ? "step" : undefined}
          >
            <button
              type="button"
              className="link"
              disabled={isGoing || index === at - 1}
              onClick={() => go(index + 1)}
            >
              {entry.label}
            </button>{" "}
            <small className="quiet">
              {entry.files.join(", ")}
              {index >= at && " · undone"}
            </small>
          </li>
        ))}
      </ol>
      <Faults revision={revision} />
    </section>
  );
}

/** What went wrong in the studio itself, with all that is known of it: for a report. */
function Faults({ revision }: { revision: number }) {
  const { value } = useAnswer("faults", {}, revision);
  if (!value?.faults.length) return null;
  return (
    <details className="faults">
      <summary>Faults ({value.faults.length})</summary>
      {value.faults.map((fault) => (
        <details key={`${fault.time} ${fault.text}`}>
          <summary>
            {clock(fault.time)} {fault.level}: {fault.text}
          </summary>
          {fault.details && <pre>{fault.details}</pre>}
        </details>
      ))}
    </details>
  );
}
