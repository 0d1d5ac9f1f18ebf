import { useState } from "react";
import { clock } from "../panels/base/parts";
import type { Alarm, HandoffRequest } from "./protocol";
import { useStill } from "./still";
import { commands, tried, useUnit } from "./unit";

const NO_ALARMS: Alarm[] = [];
const NO_REQUESTS: HandoffRequest[] = [];

/** What nobody should overlook, until somebody says why it may be silent: the newest cause first. */
export function Alarms() {
  const sounding = useUnit((unit) => unit.state?.alarms ?? NO_ALARMS);
  const mayCommand = useUnit((unit) => unit.mayCommand);
  const [reason, setReason] = useState("");
  const { shown, waiting, isGone, hand } = useStill(sounding, (alarm) => alarm.number);
  const soundingOf = (alarms: Alarm[]) => alarms.filter((alarm) => !isGone(alarm));
  const mayBeSilent = (alarms: Alarm[]) => reason.trim() !== "" && soundingOf(alarms).length > 0;
  const silence = (alarms: Alarm[]) =>
    void tried("silence", { numbers: soundingOf(alarms).map((alarm) => alarm.number), reason });
  return (
    <section
      className={sounding.length ? "alarms sounding" : "alarms"}
      aria-label="Alarms"
      {...hand}
    >
      <header>
        <h2 aria-live="assertive">
          {sounding.length
            ? `⚠ ${sounding.length} alarm${sounding.length > 1 ? "s" : ""}`
            : "No alarms"}
          {waiting > 0 && `, ${waiting} newer`}
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
            <button type="button" disabled={!mayBeSilent(shown)} onClick={() => silence(shown)}>
              Silence all
            </button>
          </>
        )}
      </header>
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: it scrolls by keys */}
      <ul tabIndex={0} aria-label="Alarms that sound">
        {causesOf(shown).map(([cause, alarms]) => (
          <li key={cause}>
            {mayCommand && (
              <button
                type="button"
                aria-label={`Silence ${cause}`}
                disabled={!mayBeSilent(alarms)}
                onClick={() => silence(alarms)}
              >
                Silence
              </button>
            )}{" "}
            <strong>{cause}</strong>
            {alarms.map((alarm) => (
              <p key={alarm.number} className={isGone(alarm) ? "gone" : ""}>
                <time>{clock(alarm.time)}</time> {alarm.subject !== cause && `${alarm.subject}: `}
                {alarm.text}
                {alarm.back > 0 && <strong> · back again {clock(alarm.back)}</strong>}
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
  const requests = useUnit((unit) => unit.state?.requests ?? NO_REQUESTS);
  const { shown, waiting, isGone, hand } = useStill(requests, keyOf);
  return (
    <section className="requests" aria-label="Requests for control" {...hand}>
      <h2 aria-live="assertive">
        {requests.length ? `${requests.length} ask for control` : "Nobody asks for control"}
        {waiting > 0 && `, ${waiting} newer`}
      </h2>
      <ul>
        {shown.map((request) => (
          <Request key={keyOf(request)} request={request} isGone={isGone(request)} />
        ))}
      </ul>
    </section>
  );
}

const keyOf = ({ component, number }: HandoffRequest) => `${component} ${number}`;

const DECISIONS = [
  ["grant", "Grant"],
  ["deny", "Deny"],
  ["defer", "Defer"],
] as const;

function Request({ request, isGone }: { request: HandoffRequest; isGone: boolean }) {
  const isOurs = useUnit(commands);
  const { component, number } = request;
  return (
    <li className={isGone ? "gone" : ""}>
      {request.client} asks for control of {component} with authority {request.authority}:{" "}
      {request.explanation || "without a reason"}
      {DECISIONS.map(([decision, name]) => (
        <button
          key={decision}
          type="button"
          disabled={!isOurs || isGone}
          onClick={() => void tried("decide", { component, number, decision })}
        >
          {name}
        </button>
      ))}
    </li>
  );
}

/** The alarms by cause, in the order of the first of each. */
function causesOf(alarms: Alarm[]): [string, Alarm[]][] {
  const causes = new Map<string, Alarm[]>();
  for (const alarm of alarms) causes.set(alarm.cause, [...(causes.get(alarm.cause) ?? []), alarm]);
  return [...causes];
}
