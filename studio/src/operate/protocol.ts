// What the socket of the operator unit takes and tells.

export interface NumberKind {
  integer: boolean;
  /** Smallest and largest legal value of each range. */
  ranges: [number, number][];
  /** Integers that have a meaning. */
  choices: { value: number; label: string }[];
  units: string;
}

/** A field of a message; what it may hold follows from its kind. */
export type Field = { name: string; documentation: string; optional: boolean } & (
  | ({ kind: "number" } & NumberKind)
  | { kind: "group"; members: Field[] }
  | { kind: "list"; least: number; most: number; element: Field }
  | { kind: "variant"; options: Field[] }
  | { kind: "variable"; alternatives: ({ index: number; name: string } & NumberKind)[] }
  | { kind: "text"; least: number; most: number }
  | { kind: "octets"; least: number; most: number }
  | { kind: "formatted"; least: number; most: number; formats: { index: number; name: string }[] }
);

export interface Command {
  name: string;
  service: string;
  documentation: string;
  /** Its declared stop, or why a stick cannot send it. */
  stick: { stop: string; timeout: number; source: string } | { refusal: string };
}

export interface Component {
  id: string;
  name: string;
  level: string;
  reason: string;
  state: string | null;
  controller: string | null;
  authority: number | null;
}

export interface Alarm {
  number: number;
  /** Seconds since 1970. */
  time: number;
  /** What it comes from: alarms of one cause stand together. */
  cause: string;
  subject: string;
  text: string;
  /** When the subject was well again; 0 while it is not. */
  back: number;
}

export interface JournalEntry {
  number: number;
  time: number;
  who: string;
  text: string;
}

export interface HandoffRequest {
  component: string;
  number: number;
  client: string;
  authority: number;
  explanation: string;
}

export interface UnitState {
  own: string;
  fault: string;
  /** Why models cannot be read. */
  unread: string;
  /** What the guardian cannot do. */
  unguarded: string;
  /** What Stop does; null where nobody may command. */
  stop: "standby" | "emergency" | null;
  /** Seconds that the page which commands may be silent. */
  lease: number | null;
  commander: { page: number; name: string } | null;
  holds: { component: string }[];
  requests: HandoffRequest[];
  /** The newest first. */
  alarms: Alarm[];
  /** Seconds since each component was heard. */
  ages: Record<string, number>;
}

export interface Values {
  component: string;
  report: string;
  /** Seconds since the last report, null before the first one. */
  age: number | null;
  count: number;
  /** Paths and texts. */
  fields: [string, string][];
  /** Paths of numbers, of which there is a history. */
  numbers: string[];
  /** Paths of bytes that may be a picture. */
  pictures: string[];
  /** Addresses of streams and files. */
  urls: string[];
}

type Of = { component: string };
/** Messages that are the elements of a list, in their order. */
type Drawn = Of & { message: string; elements: object[] };

/** Requests: parameters and result by method. */
export interface OperateMethods {
  claim: [{ right: string; name: string }, unknown];
  messages: [Of, { services: string[]; commands: Command[]; reports: { name: string }[] }];
  form: [Of & { message: string }, { fields: Field[] }];
  journal: [Record<string, never>, { entries: JournalEntry[] }];
  watch: [Of & { report: string; rate: number | null; fields?: object | null }, unknown];
  unwatch: [Of & { report: string }, unknown];
  values: [Record<string, never>, { values: Values[] }];
  history: [
    Of & { report: string; path: string; seconds: number; points: number },
    /**
     * `values`: null where one is no number. `now`: when it was asked, by the clock of `times`,
     * which nobody sets; `epoch`: what makes seconds since 1970 of both.
     */
    { times: number[]; values: (number | null)[]; now: number; epoch: number },
  ];
  picture: [Of & { report: string; path: string }, { url: string }];
  renew: [Record<string, never>, unknown];
  take: [Of & { authority: number }, unknown];
  release: [Of, unknown];
  resume: [Of, unknown];
  standby: [Of, unknown];
  send: [Of & { message: string; fields: object }, { answer: string }];
  stop: [
    { components: string[] },
    { stopped: { component: string; outcome: string; confirmed: boolean }[] },
  ];
  clear: [Of, unknown];
  silence: [{ numbers: number[]; reason: string }, unknown];
  handoff: [Of & { authority: number; reason: string }, unknown];
  decide: [Of & { number: number; decision: "grant" | "deny" | "defer" }, unknown];
  "list.set": [Drawn, unknown];
  /** `time`: when it began, by the clock of `history`. */
  "list.execute": [Drawn & { speed: number; first: number }, { time: number }];
  "list.end": [Of, unknown];
  "stick.begin": [Of & { message: string }, { stick: number; timeout: number }];
  "stick.move": [{ stick: number; fields: object }, unknown];
  "stick.end": [{ stick: number }, unknown];
}

export type OperateMethod = keyof OperateMethods;

export interface OperateHello {
  page: number;
  can_command: boolean;
  /** Seconds from one word to the next. */
  word: number;
  state: UnitState & { components: Component[] };
}

export interface OperateNotifications {
  "operate.state": UnitState;
  "operate.journal": { entry: JournalEntry };
  "operate.components": { components: Component[] };
  "operate.learnt": Record<string, never>;
}
