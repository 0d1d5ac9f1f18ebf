// Alarms by their cause: one that is lost takes others along.

import type { Alarm } from "./protocol";

export interface Cause {
  cause: string;
  /** The newest first. */
  alarms: Alarm[];
}

/** The alarms that are shown and sound still, as they are now, by cause in the order of the first. */
export function causesOf(shown: Alarm[], sounding: Alarm[]): Cause[] {
  const present = new Map(sounding.map((each) => [each.number, each]));
  const causes = new Map<string, Alarm[]>();
  for (const { number } of shown) {
    const alarm = present.get(number);
    if (alarm) causes.set(alarm.cause, [...(causes.get(alarm.cause) ?? []), alarm]);
  }
  return [...causes].map(([cause, alarms]) => ({ cause, alarms }));
}
