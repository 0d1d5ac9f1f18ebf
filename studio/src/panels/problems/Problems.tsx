import { useMemo, useState } from "react";
import { change, reveal } from "../../actions";
import { useTrying } from "../../answers";
import type { Cure, Problem, Severity } from "../../protocol";
import { useRevision, useStudio } from "../../store";
import { count, SEVERITIES, verdict } from "../../verdicts";
import { Fault, Level, Quiet } from "../base/parts";

const MOST_SHOWN = 500;

/** What is wrong by severity, gravest first; then by file and line. */
export function ordered(problems: readonly Problem[]): Problem[] {
  return [...problems].sort(
    (left, right) =>
      SEVERITIES.indexOf(left.severity) - SEVERITIES.indexOf(right.severity) ||
      left.file.localeCompare(right.file) ||
      left.line - right.line ||
      left.column - right.column,
  );
}

/** What the rules say about the file, as it is told after each change. */
export function Problems() {
  const report = useStudio((state) => state.problems);
  const revision = useRevision();
  const [hidden, setHidden] = useState<readonly Severity[]>([]);
  const [filter, setFilter] = useState("");
  const [fault, attempt] = useTrying();

  const all = useMemo(() => ordered(report?.problems ?? []), [report]);
  const words = filter.toLowerCase().split(/\s+/).filter(Boolean);
  const shown = all.filter((problem) => {
    const text = `${problem.message} ${problem.rule} ${problem.path} ${problem.file}`.toLowerCase();
    return !hidden.includes(problem.severity) && words.every((word) => text.includes(word));
  });

  const cure = ({ commands, label }: Cure) =>
    void attempt(() => change(commands, label, report?.revision));

  if (report === null) return <Quiet>Nothing has been checked yet.</Quiet>;
  return (
    <section className="problems" aria-label="Problems">
      <header className="bar">
        <strong className="verdict" role="status">
          {verdict(all, report.fault)}
        </strong>
        {report.revision < revision ? (
          <span className="badge">of revision {report.revision}; checking again…</span>
        ) : (
          !report.fault && (
            <span className="quiet">checked in {Math.round(report.elapsed_ms)} ms</span>
          )
        )}
        <fieldset aria-label="Severities shown">
          {SEVERITIES.map((severity) => (
            <label key={severity}>
              <input
                type="checkbox"
                checked={!hidden.includes(severity)}
                onChange={() =>
                  setHidden(
                    hidden.includes(severity)
                      ? hidden.filter((one) => one !== severity)
                      : [...hidden, severity],
                  )
                }
              />
              {count(all, severity)}
            </label>
          ))}
        </fieldset>
        <input
          type="search"
          aria-label="Filter problems"
          placeholder="Filter"
          value={filter}
          onChange={(event) => setFilter(event.currentTarget.value)}
        />
      </header>
      <Fault>{fault}</Fault>
      <ul>
        {shown.slice(0, MOST_SHOWN).map((problem) => (
          <Row key={keyOf(problem)} problem={problem} onCure={cure} />
        ))}
      </ul>
      {shown.length > MOST_SHOWN && (
        <Quiet>{`${shown.length - MOST_SHOWN} more; filter to see them.`}</Quiet>
      )}
      {all.length > 0 && shown.length === 0 && <Quiet>All problems are filtered out.</Quiet>}
    </section>
  );
}

function keyOf(problem: Problem): string {
  return [
    problem.file,
    problem.line,
    problem.column,
    problem.rule,
    problem.element,
    problem.message,
  ].join(" ");
}

function Row({ problem, onCure }: { problem: Problem; onCure: (cure: Cure) => void }) {
  const place = problem.line > 0 ? `${problem.file}:${problem.line}` : problem.file;
  return (
    <li className="problem">
      <Level level={problem.severity} />
      <div className="problem-text">
        <button
          type="button"
          className="link"
          disabled={problem.element === ""}
          onClick={() => reveal(problem.element, problem.file)}
        >
          {problem.message}
        </button>
        {problem.hint && <span>{problem.hint}</span>}
        <small className="quiet">
          {[problem.path, place, problem.rule].filter(Boolean).join(" · ")}
        </small>
      </div>
      <span className="buttons">
        {problem.cures.map((cure) => (
          <button type="button" key={cure.label} onClick={() => onCure(cure)}>
            {cure.label}
          </button>
        ))}
      </span>
    </li>
  );
}
