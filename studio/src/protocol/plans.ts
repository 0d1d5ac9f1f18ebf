// What would be generated.

import type { Severity } from "./graphs";

export type PlanAction = "create" | "change" | "keep" | "same" | "remove" | "refuse";

export interface Plan {
  out: string;
  files: { path: string; action: PlanAction; reason: string }[];
  drift: { path: string; line: number; severity: Severity; message: string; stub: string }[];
  problems: string;
  digest: string;
}
