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

export interface Problems {
  revision: number;
  elapsed_ms: number;
  files: string[];
  problems: Problem[];
}
