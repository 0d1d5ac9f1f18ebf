// The state of a running system.

export interface LiveEdge {
  level: string;
  /** It was heard, and is no more. */
  gone?: boolean;
  text: string;
}

export interface LiveBox {
  level: string;
  /** It answered, and does no more. */
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
  edges: Record<string, LiveEdge>;
  /** By id of a node of the system view, or of a box or frame of the view of a machine. */
  boxes: Record<string, LiveBox>;
}

export interface LiveMessage {
  jaus: string;
  ros: string;
  age: number | null;
}
