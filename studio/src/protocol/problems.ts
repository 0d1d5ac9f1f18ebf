// What is wrong, and what would cure it.

import type { Command } from "./commands";
import type { Severity } from "./graphs";
import type { Ref } from "./project";

export interface Cure {
  label: string;
  commands: Command[];
}

export interface Problem {
  file: string;
  line: number;
  column: number;
  severity: Severity;
  rule: string;
  message: string;
  hint: string;
  element: Ref | "";
  /** Element path by names. */
  path: string;
  cures: Cure[];
}

/** A fault of the studio itself. */
export interface LoggedFault {
  /** Seconds since 1970. */
  time: number;
  level: string;
  text: string;
  details: string;
}

export interface Problems {
  revision: number;
  /** Why no rules were run, empty when they were. */
  fault?: string;
  elapsed_ms: number;
  problems: Problem[];
}
