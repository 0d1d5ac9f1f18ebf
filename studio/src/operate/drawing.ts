// What a person has drawn, kept by the browser, and what the component tells of it.

import { type Draft, type Faults, membersOf, readGroup, withNumber } from "./fields";
import { FRAMES, type Frame, type Place } from "./plan";
import type { Field } from "./protocol";

/** A service that drives to waypoints (AS6009). */
export interface Driver {
  service: string;
  frame: Frame;
  isList: boolean;
  /** The command whose speed makes it drive; undefined where the component takes none. */
  execution: string | undefined;
}

/** The drivers among services of a component that takes commands, those of lists first. */
export function driversOf(services: readonly string[], taken: readonly string[]): Driver[] {
  const drivers = [true, false].flatMap((isList) =>
    FRAMES.map((frame) => ({
      service: `${frame.waypoint.replace(/^Set/, "")}${isList ? "List" : ""}Driver`,
      frame,
      isList,
      execution: taken.find((command) => command === (isList ? "ExecuteList" : "SetTravelSpeed")),
    })),
  );
  return drivers.filter((driver) => services.includes(driver.service));
}

export interface Drawing {
  /** What is typed and drawn, one of each waypoint. */
  waypoints: Draft[];
  /** Where the plan of it was begun. */
  origin: Place | null;
  /** The values that the component confirmed last, as JSON; empty for none. */
  sent: string;
  /** When it was told to execute them (seconds since 1970, of the server), and from which one on. */
  execution: { time: number; first: number } | null;
}

export const NOTHING: Drawing = { waypoints: [], origin: null, sent: "", execution: null };

const keyOf = (component: string, { service }: Driver): string =>
  `jausml-drawing ${component} ${service}`;

/** What was drawn; what cannot be read is nothing. */
export function load(storage: Storage, component: string, driver: Driver): Drawing {
  try {
    const kept = JSON.parse(storage.getItem(keyOf(component, driver)) ?? "{}");
    return Array.isArray(kept.waypoints) ? { ...NOTHING, ...kept } : NOTHING;
  } catch {
    return NOTHING;
  }
}

export function save(storage: Storage, component: string, driver: Driver, drawing: Drawing): void {
  storage.setItem(keyOf(component, driver), JSON.stringify(drawing));
}

/** The waypoints as they are sent, with what is wrong by the paths of the fields. */
export function readWaypoints(
  fields: Field[],
  waypoints: readonly Draft[],
): { values: Record<string, unknown>[]; faults: Faults } {
  const faults: Faults = new Map();
  const values = waypoints.map((waypoint, at) =>
    readGroup(fields, waypoint, `elements[${at}]`, faults),
  );
  return { values, faults };
}

/** Where a waypoint is; undefined as long as it is nowhere. */
export function placeIn(
  draft: Draft | undefined,
  fields: Field[],
  frame: Frame,
): Place | undefined {
  const record = fields[0];
  if (record?.kind !== "group") return undefined;
  const faults: Faults = new Map();
  const axes = record.members.filter((member) => frame.paths.includes(member.name));
  const read = readGroup(axes, membersOf(draft)[record.name], "", faults);
  const [first, second] = frame.paths.map((path) => read[path]);
  return faults.size === 0 && typeof first === "number" && typeof second === "number"
    ? [first, second]
    : undefined;
}

/** A waypoint at another place; what else stands in it stays. */
export function movedTo(draft: Draft, fields: Field[], frame: Frame, place: Place): Draft {
  const record = fields[0]?.name ?? "";
  return frame.paths.reduce(
    (changed, path, axis) => withNumber(changed, [record, path], place[axis] ?? 0),
    draft,
  );
}

export interface Progress {
  active: number;
  /** Whether a waypoint, counted from 1, was reached. */
  isReached(at: number): boolean;
  text: string;
}

/** What the reports of the active element since an execution tell of it. */
export function progressOf(
  { execution }: Drawing,
  count: number,
  reports: { times: number[]; values: (number | null)[] },
): Progress | undefined {
  if (!execution) return undefined;
  const { time, first } = execution;
  const uids = reports.values.filter(
    (uid, index): uid is number => uid !== null && (reports.times[index] ?? 0) >= time,
  );
  const active = uids.at(-1);
  const last = uids.findLast((uid) => uid !== 0) ?? 0;
  const ends = last > count ? 0 : active === 0 && last === count ? count : last - 1;
  return {
    active: active ?? 0,
    isReached: (at) => first <= at && at <= ends,
    text:
      active === undefined
        ? "It has not told its active element yet."
        : active > count
          ? `It executes another list: element ${active} is active.`
          : active > 0
            ? `It drives to waypoint ${active} of ${count}.`
            : last === 0
              ? "It executes no element."
              : last === count
                ? `Ended behind the last waypoint, ${count}.`
                : `Ended on the way to waypoint ${last} of ${count}.`,
  };
}
