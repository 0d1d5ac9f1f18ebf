// Findings in words.

import type { Problem, Severity } from "./protocol";

/** The gravest first. */
export const SEVERITIES: Severity[] = ["error", "warning", "info"];
const NAMES: Record<Severity, [string, string]> = {
  error: ["error", "errors"],
  warning: ["warning", "warnings"],
  info: ["remark", "remarks"],
};

export function count(problems: readonly Problem[], severity: Severity): string {
  const number = problems.filter((problem) => problem.severity === severity).length;
  return `${number} ${NAMES[severity][number === 1 ? 0 : 1]}`;
}

/** The verdict in one line. */
export function verdict(problems: readonly Problem[], fault = ""): string {
  if (fault) return `Not checked: ${fault}.`;
  if (problems.length === 0) return "No problems.";
  const counts = SEVERITIES.filter((severity) =>
    problems.some((problem) => problem.severity === severity),
  );
  return `${counts.map((severity) => count(problems, severity)).join(", ")}.`;
}
