// The page's end of the operator unit: its socket, what it knows, and the lease that it renews.

import { create } from "zustand";
import { type Answer, useAnswerOf } from "../answers";
import {
  type Caller,
  Connection,
  type Link,
  type Listener,
  messageOf,
  RIGHT_KEY,
  socketAddress,
  TOKEN_KEY,
} from "../connection";
import { clock } from "../panels/base/parts";
import type {
  Component,
  JournalEntry,
  OperateHello,
  OperateMethod,
  OperateMethods,
  OperateNotifications,
  UnitState,
} from "./protocol";

/** Whether this tab was opened with the right to command. */
export const hasRight = (): boolean => sessionStorage.getItem(RIGHT_KEY) !== null;

const MOST_ENTRIES = 500;
const NAME_KEY = "jausml-operator";
/** Renewals in one lease: some may come late. */
const RENEWALS = 4;
const SHORTEST_MS = 50;
/** From one look at the clock to the next. */
const LOOK_MS = 200;

const BEGINNING = {
  link: "opening" as Link,
  refusal: "",
  page: 0,
  /** Seconds from one word of the unit to the next. */
  word: 1,
  canCommand: false,
  mayCommand: false,
  /** Why the right was refused. */
  noRight: "",
  state: null as UnitState | null,
  components: [] as Component[],
  journal: [] as JournalEntry[],
  /** The component that is chosen. */
  chosen: "",
  /** When the unit said its last word, and now: milliseconds of a clock that never goes back. */
  heard: 0,
  now: 0,
  /** Seconds since then, and whether a word was missed: nothing that is shown is current then. */
  silence: 0,
  isStale: false,
  /** Counts how often the unit has learnt what models say. */
  learnt: 0,
  /** The stop that was pressed last, and what became of it; empty while nobody has said it. */
  stopping: null as { since: number; outcome: string } | null,
  /** What went wrong last, and what went well. */
  said: { text: "", isError: false },
};

type Unit = typeof BEGINNING;

export const useUnit = create(() => BEGINNING);

export const unit = (): Unit => useUnit.getState();
const put = useUnit.setState;
export const choose = (chosen: string): void => put({ chosen });
export const tell = (text: string, isError = false): void => put({ said: { text, isError } });

let caller: Caller | null = null;

export function setCaller(other: Caller): void {
  caller = other;
}

/** Asks the unit. */
export function ask<M extends OperateMethod>(
  method: M,
  params: OperateMethods[M][0],
): Promise<OperateMethods[M][1]> {
  if (!caller) return Promise.reject(new Error("There is no connection to the operator unit."));
  return caller.call(method, params) as Promise<OperateMethods[M][1]>;
}

/** Asks, and tells what went wrong; undefined then. */
export async function tried<M extends OperateMethod>(
  method: M,
  params: OperateMethods[M][0],
): Promise<OperateMethods[M][1] | undefined> {
  try {
    return await ask(method, params);
  } catch (error) {
    tell(messageOf(error), true);
    return undefined;
  }
}

/** What the unit answers: see `useAnswerOf`. */
export const useAnswer = <M extends OperateMethod>(
  method: M,
  params: OperateMethods[M][0] | null,
  revision?: unknown,
  subject?: string,
): Answer<OperateMethods[M][1]> => useAnswerOf(ask<M>, method, params, revision, subject);

/** Opens the socket, once for the page. */
export function open(): void {
  if (caller) return;
  const token = sessionStorage.getItem(TOKEN_KEY) ?? "";
  const connection = new Connection(socketAddress(window.location, "/socket"), token, LISTENER);
  setCaller(connection);
  connection.open();
  setInterval(look, LOOK_MS);
  document.addEventListener("visibilitychange", look);
}

/** Looks how old the last word is. */
export function look(): void {
  const { heard, word, isStale: was } = unit();
  const now = performance.now();
  const silence = (now - heard) / 1000;
  // One word that is missing is enough; it may be late by as much.
  const isStale = heard > 0 && silence > 2 * word;
  put({ now, silence, isStale });
  if (isStale && !was) tell("");
}

const LISTENER: Listener = {
  onLink(link: Link, hello: unknown, refusal: string) {
    put({ link, refusal });
    if (link !== "open") put({ mayCommand: false });
    if (hello) void begin(hello as OperateHello);
  },
  onNotification<N extends keyof OperateNotifications>(name: N, params: OperateNotifications[N]) {
    if (name === "operate.learnt") put((before) => ({ learnt: before.learnt + 1 }));
    if (name === "operate.components") put(params as OperateNotifications["operate.components"]);
    if (name === "operate.state") take(params as UnitState);
    if (name === "operate.journal") {
      const { entry } = params as OperateNotifications["operate.journal"];
      put((before) => ({ journal: [...before.journal, entry].slice(-MOST_ENTRIES) }));
    }
  },
};

export function take(state: UnitState): void {
  const now = performance.now();
  put({ state, heard: now, now, silence: 0, isStale: false });
  pace();
}

async function begin(hello: OperateHello): Promise<void> {
  put({ page: hello.page, word: hello.word, canCommand: hello.can_command });
  put({ components: hello.state.components });
  take(hello.state);
  const right = sessionStorage.getItem(RIGHT_KEY);
  if (right !== null && hello.can_command) await claim(right, ownName());
  const journal = await tried("journal", {});
  if (journal) put({ journal: journal.entries.slice(-MOST_ENTRIES) });
}

export const ownName = (): string => localStorage.getItem(NAME_KEY) ?? "";

/** Says how others are to call this page. */
export async function rename(name: string): Promise<void> {
  localStorage.setItem(NAME_KEY, name);
  const right = sessionStorage.getItem(RIGHT_KEY);
  if (right !== null) await claim(right, name);
}

async function claim(right: string, name: string): Promise<void> {
  try {
    await ask("claim", { right, name });
    put({ mayCommand: true, noRight: "" });
  } catch (error) {
    put({ mayCommand: false, noRight: messageOf(error) });
  }
}

// ---- the lease -----------------------------------------------------------------------------------

let timer: ReturnType<typeof setInterval> | undefined;
let pacedBy = 0;
let isTaking = false;

/** Whether this page commands. */
export const commands = ({ state, page }: Unit): boolean => state?.commander?.page === page;

/** Renews the lease while this page commands, and as long as somebody can see it. */
function pace(): void {
  const seconds = unit().state?.lease ?? 0;
  const wanted = seconds > 0 && (commands(unit()) || isTaking) ? seconds : 0;
  if (wanted === pacedBy) return;
  pacedBy = wanted;
  clearInterval(timer);
  if (wanted === 0) return;
  renew();
  timer = setInterval(renew, Math.max(SHORTEST_MS, (1000 * wanted) / RENEWALS));
}

function renew(): void {
  // Who does not see the page does not command: the server stops what it controls.
  if (document.hidden) return;
  ask("renew", {}).catch(() => undefined);
}

/** Takes control, or asks for it; the lease is renewed from the first moment on. */
export async function taking(work: Promise<unknown>): Promise<void> {
  isTaking = true;
  pace();
  try {
    await work;
    tell("Control was given.");
  } catch (error) {
    tell(messageOf(error), true);
  } finally {
    isTaking = false;
    pace();
  }
}

// ---- the stop ------------------------------------------------------------------------------------

/** Stops all that is controlled; what is chosen too, where the stop needs no control. */
export async function stop(): Promise<void> {
  const { state, chosen } = unit();
  const holds = state?.holds.map((hold) => hold.component) ?? [];
  const isForAll = state?.stop === "emergency" || holds.length === 0;
  const components = chosen && isForAll ? [chosen] : [];
  const pressed = { since: performance.now(), outcome: "" };
  put({ stopping: pressed });
  // With its time: it stands there until the next one, and may be true no more.
  const become = (outcome: string) => {
    const timed = `${clock(Date.now() / 1000)} ${outcome}`;
    if (unit().stopping === pressed) put({ stopping: { ...pressed, outcome: timed } });
  };
  try {
    const { stopped } = await ask("stop", { components });
    const outcomes = stopped.map((target) => `${nameOf(target.component)}: ${target.outcome}`);
    const all = stopped.every((target) => target.confirmed)
      ? "Stopped."
      : "✖ Not all is known to stand.";
    become(outcomes.length ? `${all} ${outcomes.join("; ")}` : "Nothing is controlled.");
  } catch (error) {
    const lease = state?.commander?.page === unit().page ? ` ${state?.lease} s` : "";
    const rest = lease && ` What this page commands is stopped after${lease} of silence.`;
    become(`Not told: ${messageOf(error)}${rest}`);
  }
}

/** The name of a component with its JAUS id. */
export function nameOf(id: string): string {
  const name = unit().components.find((component) => component.id === id)?.name;
  return name ? `${name} (${id})` : id;
}
