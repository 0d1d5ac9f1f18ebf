import { useRef, useState } from "react";
import type { Alarm, HandoffRequest } from "./protocol";
import { commands, tried, useUnit } from "./unit";

const timeOf = (seconds: number) => new Date(seconds * 1000).toISOString().slice(11, 19);
const NONE: Alarm[] = [];

/** What nobody should overlook, until somebody says why it may be silent: the newest cause first. */
export function Alarms() {
  const sounding = useUnit((unit) => unit.state?.alarms ?? NONE);
  const mayCommand = useUnit((unit) => unit.mayCommand);
  const [reason, setReason] = useState("");
  const [isTouched, setTouched] = useState(false);
  // Nothing moves under the hand: while it is here, what is newer waits.
  const shown = useRef(sounding);
  if (!isTouched) shown.current = sounding;
  const newer = sounding.filter((each) => !shown.current.some((one) => one.number === each.number));
  const causes = causesOf(shown.current, sounding);
  const silence = (alarms: Alarm[]) =>
    void tried("silence", { numbers: alarms.map((each) => each.number), reason });
  return (
    <section
      className={sounding.length ? "alarms sounding" : "alarms"}
      aria-label="Alarms"
      onPointerEnter={() => setTouched(true)}
      onPointerLeave={() => setTouched(false)}
      onFocus={() => setTouched(true)}
      onBlur={() => setTouched(false)}
    >
      <header>
        <h2 aria-live="assertive">
          {sounding.length
            ? `⚠ ${sounding.length} alarm${sounding.length > 1 ? "s" : ""}`
            : "No alarms"}
          {newer.length > 0 && `, ${newer.length} newer`}
        </h2>
        {mayCommand && (
          <>
            <input
              aria-label="Why may they be silent?"
              placeholder="reason"
              size={14}
              value={reason}
              onChange={(event) => setReason(event.currentTarget.value)}
            />
            <button
              type="button"
              disabled={reason.trim() === "" || shown.current.length === 0}
              onClick={() => silence(shown.current)}
            >
              Silence all
            </button>
          </>
        )}
      </header>
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: it scrolls by keys */}
      <ul tabIndex={0} aria-label="Alarms that sound">
        {causes.map(({ cause, alarms }) => (
          <li key={cause}>
            {mayCommand && (
              <button
                type="button"
                aria-label={`Silence ${cause}`}
                disabled={reason.trim() === ""}
                onClick={() => silence(alarms)}
              >
                Silence
              </button>
            )}{" "}
            <strong>{cause}</strong>
            {alarms.map((each) => (
              <p key={each.number}>
                <time>{timeOf(each.time)}</time> {each.subject !== cause && `${each.subject}: `}
                {each.text}
                {each.back > 0 && <strong> · back again {timeOf(each.back)}</strong>}
              </p>
            ))}
          </li>
        ))}
      </ul>
    </section>
  );
}

/** Who asks for control of what is controlled here; a person decides. */
export function Requests() {
  const requests = useUnit((unit) => unit.state?.requests ?? null);
  return (
    <section className="requests" aria-label="Requests for control">
      <h2 aria-live="assertive">
        {requests?.length ? `${requests.length} ask for control` : "Nobody asks for control"}
      </h2>
      <ul>
        {requests?.map((each) => (
          <Request key={`${each.component} ${each.number}`} request={each} />
        ))}
      </ul>
    </section>
  );
}

const DECISIONS = [
  ["grant", "Grant"],
  ["deny", "Deny"],
  ["defer", "Defer"],
] as const;

function Request({ request }: { request: HandoffRequest }) {
  const isOurs = useUnit(commands);
  const { component, number } = request;
  return (
    <li>
      {request.client} asks for control of {component} with authority {request.authority}:{" "}
      {request.explanation || "without a reason"}
      {DECISIONS.map(([decision, name]) => (
        <button
          key={decision}
          type="button"
          disabled={!isOurs}
          onClick={() => void tried("decide", { component, number, decision })}
        >
          {name}
        </button>
      ))}
    </li>
  );
}

/** The alarms that are shown and sound still, as they are now, by cause in the order of the first. */
export function causesOf(shown: Alarm[], sounding: Alarm[]) {
  const present = new Map(sounding.map((each) => [each.number, each]));
  const causes = new Map<string, Alarm[]>();
  for (const { number } of shown) {
    const alarm = present.get(number);
    if (alarm) causes.set(alarm.cause, [...(causes.get(alarm.cause) ?? []), alarm]);
  }
  return [...causes].map(([cause, alarms]) => ({ cause, alarms }));
}
