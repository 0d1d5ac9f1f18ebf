import { useState } from "react";
import type { Alarm } from "./protocol";
import { tried, useUnit } from "./unit";

const timeOf = (seconds: number) => new Date(seconds * 1000).toLocaleTimeString();

/** What nobody should overlook, until somebody says why it may be silent. */
export function Alarms() {
  const alarms = useUnit((unit) => unit.state?.alarms ?? null);
  const sounding = (alarms ?? []).filter((each) => each.silenced === "");
  if (sounding.length === 0) return null;
  return (
    <section className="alarms" role="alert" aria-label="Alarms">
      <h2>
        <span aria-hidden="true">⚠</span> {sounding.length} alarm{sounding.length > 1 ? "s" : ""}
      </h2>
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: it scrolls by keys */}
      <ul tabIndex={0} aria-label="Alarms that sound">
        {sounding.map((each) => (
          <Sounding key={each.number} alarm={each} />
        ))}
      </ul>
    </section>
  );
}

function Sounding({ alarm }: { alarm: Alarm }) {
  const mayCommand = useUnit((unit) => unit.mayCommand);
  const [reason, setReason] = useState("");
  return (
    <li>
      <time>{timeOf(alarm.time)}</time> <strong>{alarm.subject}</strong> {alarm.text}
      {mayCommand && (
        <form
          onSubmit={(event) => {
            event.preventDefault();
            void tried("silence", { number: alarm.number, reason });
          }}
        >
          <input
            aria-label={`Why is ${alarm.subject} silenced?`}
            placeholder="reason"
            value={reason}
            onChange={(event) => setReason(event.currentTarget.value)}
          />
          <button type="submit" disabled={reason.trim() === ""}>
            Silence
          </button>
        </form>
      )}
    </li>
  );
}
