// Machines that are stepped by hand.

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
