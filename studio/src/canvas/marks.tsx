import type { Finding, LivePart, Severity } from "../protocol";
import { SEVERITIES } from "../verdicts";

export const SIGNS: Record<Severity, string> = { error: "×", warning: "!", info: "i" };

/** The gravest severity, empty without findings. */
export function severityOf(findings: readonly Finding[]): Severity | "" {
  return (
    SEVERITIES.find((severity) => findings.some((finding) => finding.severity === severity)) ?? ""
  );
}

/** Findings as sentences, for titles and labels. */
export function told(findings: readonly Finding[]): string {
  return findings.map((finding) => `${finding.severity}: ${finding.message}`).join("\n");
}

/** A sign for what is wrong, with its words for whoever points at it or listens. */
export function Mark({ findings }: { findings: readonly Finding[] }) {
  const severity = severityOf(findings);
  if (!severity) return null;
  return (
    <span className={`mark ${severity}`} title={told(findings)} role="img" aria-label={severity}>
      {SIGNS[severity]}
    </span>
  );
}

/** How a live part stands out: never by colour alone. */
export function liveClass(live: LivePart | undefined): string {
  if (!live) return "";
  if (live.gone) return "live-failing live-gone";
  if (live.level === "ok") return "live-ok";
  if (["active", "around", "left"].includes(live.level)) return `live-${live.level}`;
  if (live.level === "error" || live.level === "warning") return `live-failing live-${live.level}`;
  return "live-silent";
}

const LEVEL_SIGNS: Record<string, string> = {
  ok: "✓",
  warning: "!",
  error: "×",
  active: "●",
  around: "●",
  left: "○",
};

/** The words of a live part, with a sign for its level. */
export function liveText(live: LivePart): string {
  return `${live.gone ? "✝" : (LEVEL_SIGNS[live.level] ?? "?")} ${live.text}`;
}

/** A DOM id of a part, which `aria-activedescendant` can name. */
export const domId = (key: string): string => `part-${encodeURIComponent(key)}`;
