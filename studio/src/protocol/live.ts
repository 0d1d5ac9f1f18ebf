// A running system, a recording of one, and a machine that is stepped by hand.

/** What is known of a line or a box. */
export interface LivePart {
  level: string;
  /** It was heard, and is no more. */
  gone?: boolean;
  text: string;
}

/** What is known of a connection, as `jausml top --json` tells it. */
export interface LiveConnection {
  bridge: string;
  connection: string;
  /** Id of its row in the system view, empty where the model has none. */
  row: string;
  level: string;
  reason: string;
  rate: number | null;
  declared_rate: number | null;
  age: number | null;
  latency_us: Record<string, number>;
  drops: Record<string, number>;
  /** Seconds since its bridge told something. */
  told: number | null;
}

/** A state machine of a component, which provides MachineStates. */
export interface LiveMachine {
  /** URN of the service that has it. */
  service: string;
  machine: string;
  /** Path of the present state. */
  state: string | null;
  /** Seconds in it. */
  seconds: number;
  /** Whether the model has this state. */
  known: boolean;
  /** The states it was in, those with the most time first. */
  times: { state: string; entries: number; seconds: number }[];
}

export interface LiveComponent {
  id: string;
  name: string;
  level: string;
  reason: string;
  state: string | null;
  controller: string | null;
  machines?: LiveMachine[];
  round_trip_ms: number | null;
  /** Seconds since its last answer. */
  told?: number | null;
}

export interface LiveState {
  health?: string;
  sources?: Record<string, string>;
  connections?: LiveConnection[];
  components?: LiveComponent[];
  /** By id of an edge or a port of the system view. */
  edges: Record<string, LivePart>;
  /** By id of a node of the system view, or of a box or frame of the view of a machine. */
  boxes: Record<string, LivePart>;
}

export interface LiveMessage {
  jaus: string;
  ros: string;
  age: number | null;
}

/** Something that changed between two moments; times are seconds since the beginning. */
export interface Mark {
  kind: "drop" | "state" | "control";
  time: number;
  /** Bridge and connection; an address and nothing for a component. */
  bridge: string;
  connection: string;
}

/** A recording that is read. */
export interface ReadRecording {
  duration: number;
  /** What of the file cannot be read. */
  damage: string;
  /** Why it tells nothing of ROS, or of JAUS. */
  sources: Record<string, string>;
  unreadable: number;
  marks: Mark[];
  /** Marks that are too many to be listed. */
  unlisted: number;
}

export interface Explanation {
  /** The time that is explained: that of the last drop. */
  at: number;
  counter: string[];
  state: string[];
}

/** A step that was chosen, with what conditions of the user say of it. */
export interface ChosenStep {
  actor: string;
  what: string;
  said: Record<string, boolean>;
}

/** What can happen in a state, or what has happened. */
export interface StepChoice {
  kind: "message" | "event" | "core" | "time";
  actor: string;
  what: string;
  /** Path of the state after it. */
  state: string;
  /** Id of the line or row that is taken; empty where the core services alone act. */
  transition: string;
  /** Why nothing happens, empty when something does. */
  why_not: string;
}

export interface Stepping {
  component: string;
  /** Seconds of one step of time. */
  tick: number;
  /** Machines of the component that may act meanwhile, and are not stepped. */
  beside: string[];
  conditions: string[];
  initial: string;
  taken: StepChoice[];
  /** Why the path cannot be gone any more. */
  fault: string;
  state: string;
  status: string;
  controller: string;
  choices: StepChoice[];
}
