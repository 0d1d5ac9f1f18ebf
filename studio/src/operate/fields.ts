// What is typed into a form, and the fields of a message that it means.

import type { Field, NumberKind } from "./protocol";

/** What stands in a field: texts as typed, nothing made up. */
export type Draft = string | Draft[] | { [name: string]: Draft };

/** What is wrong, by the path of its field. */
export type Faults = Map<string, string>;

type Members = { [name: string]: Draft };

const THERE = "_there";
const isMembers = (draft: Draft | undefined): draft is Members =>
  typeof draft === "object" && !Array.isArray(draft);

export const textOf = (draft: Draft | undefined): string =>
  typeof draft === "string" ? draft : "";
export const itemsOf = (draft: Draft | undefined): Draft[] => (Array.isArray(draft) ? draft : []);
export const membersOf = (draft: Draft | undefined): Members => (isMembers(draft) ? draft : {});

/** Whether an optional group was asked for. */
export const isThere = (field: Field, draft: Draft | undefined): boolean =>
  !field.optional || membersOf(draft)[THERE] !== undefined;
export const asThere = (draft: Draft | undefined, is: boolean): Draft =>
  is ? { ...membersOf(draft), [THERE]: "yes" } : {};

export const pathOf = (before: string, name: string): string =>
  before ? `${before}.${name}` : name;

/** The value of a field in the shape that the server takes, undefined for one that is left out. */
function readField(field: Field, draft: Draft | undefined, path: string, faults: Faults): unknown {
  switch (field.kind) {
    case "number":
      return readNumber(field, textOf(draft), field.optional, path, faults);
    case "group":
      if (!isThere(field, draft)) return undefined;
      return readGroup(field.members, draft, path, faults);
    case "list":
      return listOf(field, itemsOf(draft), path, faults);
    case "variant": {
      const tag = textOf(membersOf(draft)._tag);
      const option = field.options[Number(tag)];
      if (tag === "" || !option) return missing(field, path, faults);
      const inner = readField(option, membersOf(draft).value, pathOf(path, option.name), faults);
      return { _tag: Number(tag), [option.name]: inner };
    }
    case "variable": {
      const { index, value } = membersOf(draft);
      const alternative = field.alternatives.find(
        (option) => String(option.index) === textOf(index),
      );
      if (!alternative) return missing(field, path, faults);
      const number = readNumber(alternative, textOf(value), false, path, faults);
      return { index: alternative.index, value: number };
    }
    case "text":
      return charactersOf(field, textOf(draft), path, faults);
    case "octets": {
      const hex = octetsOf(field, textOf(draft), path, faults);
      return hex === undefined ? undefined : { hex };
    }
    case "formatted": {
      const { format, hex } = membersOf(draft);
      if (!textOf(format)) return missing(field, path, faults);
      return { format: Number(textOf(format)), hex: octetsOf(field, textOf(hex), path, faults) };
    }
  }
}

export function readGroup(
  members: Field[],
  draft: Draft | undefined,
  path: string,
  faults: Faults,
): Record<string, unknown> {
  const values: Record<string, unknown> = {};
  for (const member of members) {
    const value = readField(
      member,
      membersOf(draft)[member.name],
      pathOf(path, member.name),
      faults,
    );
    if (value !== undefined) values[member.name] = value;
  }
  return values;
}

function missing(field: Field, path: string, faults: Faults): undefined {
  if (!field.optional) faults.set(path, "This is needed.");
  return undefined;
}

export const rangesOf = ({ ranges, units }: NumberKind): string =>
  `${ranges.map(([low, high]) => (low === high ? `${low}` : `${low} .. ${high}`)).join(", ")}${
    units ? ` ${units}` : ""
  }`;

export function readNumber(
  kind: NumberKind,
  text: string,
  isOptional: boolean,
  path: string,
  faults: Faults,
): number | undefined {
  const typed = text.trim();
  if (typed === "") {
    if (!isOptional) faults.set(path, "This is needed.");
    return undefined;
  }
  const value = Number(typed);
  if (!Number.isFinite(value)) faults.set(path, `${typed} is no number.`);
  else if (kind.integer && !Number.isInteger(value))
    faults.set(path, `${typed} is no whole number.`);
  else if (kind.integer && !Number.isSafeInteger(value))
    faults.set(path, `${typed} has more digits than can be sent.`);
  else if (!kind.ranges.some(([low, high]) => low <= value && value <= high)) {
    faults.set(path, `${typed} is not within ${rangesOf(kind)}.`);
  }
  return value;
}

function listOf(
  field: Field & { kind: "list" },
  items: Draft[],
  path: string,
  faults: Faults,
): unknown[] | undefined {
  if (items.length === 0 && field.optional) return undefined;
  if (items.length < field.least) faults.set(path, `At least ${field.least} are needed.`);
  if (items.length > field.most) faults.set(path, `At most ${field.most} are taken.`);
  return items.map((item, index) => readField(field.element, item, `${path}[${index}]`, faults));
}

function charactersOf(
  field: Field & { kind: "text" },
  text: string,
  path: string,
  faults: Faults,
): string | undefined {
  if (text === "" && field.optional) return undefined;
  if (text.length < field.least) faults.set(path, `At least ${field.least} characters are needed.`);
  if (text.length > field.most) faults.set(path, `At most ${field.most} characters fit.`);
  return text;
}

function octetsOf(
  { least, most, optional }: { least: number; most: number; optional: boolean },
  text: string,
  path: string,
  faults: Faults,
): string | undefined {
  const hex = text.replace(/\s/g, "");
  if (hex === "" && optional) return undefined;
  if (!/^([0-9a-f]{2})*$/i.test(hex)) faults.set(path, "Bytes are pairs of hexadecimal digits.");
  else if (hex.length / 2 < least) faults.set(path, `At least ${least} bytes are needed.`);
  else if (hex.length / 2 > most) faults.set(path, `At most ${most} bytes fit.`);
  return hex;
}

/** A number of a form that a stick may move. */
export interface Axis {
  /** Names from the outermost group to the number. */
  steps: string[];
  kind: NumberKind;
}

/** The numbers that a stick may move: those that may be 0 and are no choice, outside of lists. */
export function axesOf(fields: Field[], before: string[] = []): Axis[] {
  return fields.flatMap((field) => {
    const steps = [...before, field.name];
    if (field.kind === "group") return axesOf(field.members, steps);
    const isAxis = field.kind === "number" && field.choices.length === 0 && aroundZero(field);
    return isAxis ? [{ steps, kind: field }] : [];
  });
}

/** The range of a number that 0 is in. */
const aroundZero = ({ ranges }: NumberKind): [number, number] | undefined =>
  ranges.find(([low, high]) => low <= 0 && 0 <= high);

/** The value of a stick: a part of full, as far as the range around 0 goes. */
export function valueAt(kind: NumberKind, part: number, full: number): number {
  const [low, high] = aroundZero(kind) ?? [0, 0];
  const value = Math.max(low, Math.min(high, part * full));
  return kind.integer ? Math.round(value) : value;
}

/** Why a value cannot be full deflection; empty where it can. */
export function faultOfFull(kind: NumberKind, text: string): string {
  const full = Number(text);
  if (text.trim() === "" || !Number.isFinite(full) || full === 0) return "Say what full is.";
  return valueAt(kind, 1, full) === full ? "" : `Full is not within ${rangesOf(kind)}.`;
}

/** What is typed, with a number in its place, and the groups around it there. */
export function withNumber(draft: Draft, [step, ...rest]: string[], value: number): Draft {
  if (step === undefined) return String(value);
  const members = membersOf(draft);
  return { ...members, [THERE]: "yes", [step]: withNumber(members[step] ?? {}, rest, value) };
}
