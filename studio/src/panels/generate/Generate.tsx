import { useState } from "react";
import { ask } from "../../actions";
import { useTrying } from "../../answers";
import type { Plan, PlanAction } from "../../protocol";
import { say, useRevision, useStudio } from "../../store";
import { Diff } from "../base/Diff";
import { Copyable, Fault, Level, Quiet } from "../base/parts";
import { useAnswer } from "../base/useAnswer";

const ACTIONS: [PlanAction, string, string][] = [
  ["refuse", "refused", "edited by hand; it stays as it is"],
  ["create", "to create", ""],
  ["change", "to change", ""],
  ["remove", "to remove", ""],
  ["keep", "to keep", "yours; written once and never again"],
  ["same", "unchanged", ""],
];
const WRITTEN: PlanAction[] = ["create", "change", "remove"];

/** Returns a text as one word of a shell. */
export function quoted(text: string): string {
  return /^[\w@%+=:,./-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`;
}

/** What would be generated, file by file, and the button that does it. */
export function Generate() {
  const file = useStudio((state) => state.file);
  const revision = useRevision();
  const [typed, setTyped] = useState("");
  const [out, setOut] = useState("");
  const [force, setForce] = useState(false);
  const question = file ? { file, out, force } : null;
  // What is kept, or done after all, makes another plan of the same files.
  const kept = useStudio((state) => state.kept);
  const asked = `${revision} ${kept.map((edit) => edit.number).join(" ")}`;
  const { value: plan, error, isPending, again } = useAnswer("plan", question, asked);
  const [shown, setShown] = useState("");
  const [message, setMessage] = useState("");
  const [fault, attempt] = useTrying();
  const [isWriting, setWriting] = useState(false);

  if (!file) return <Quiet>No file is open.</Quiet>;

  async function write(taken: Plan) {
    setWriting(true);
    await attempt(async () => {
      const { out, digest } = taken;
      const done = await ask("generate", { file, out, digest, force });
      setMessage(done.message);
      setForce(false);
      say(done.message);
    });
    setWriting(false);
    again();
  }

  const refused = plan?.files.filter((planned) => planned.action === "refuse").length ?? 0;
  const hasWork = plan?.files.some((planned) => WRITTEN.includes(planned.action)) ?? false;
  const isThere = plan?.files.some(
    (planned) => planned.action !== "create" && planned.action !== "refuse",
  );
  const isUpToDate = plan?.problems === "" && !hasWork && refused === 0;
  return (
    <section className="generate" aria-label="Generate">
      <header className="bar">
        <label>
          Folder{" "}
          <input
            type="text"
            size={Math.max(24, (typed || plan?.out || "").length)}
            value={typed || out}
            placeholder={plan?.out ?? ""}
            onChange={(event) => setTyped(event.currentTarget.value)}
            onBlur={() => setOut(typed.trim())}
            onKeyDown={(event) => event.key === "Enter" && setOut(typed.trim())}
          />
        </label>
        <button
          type="button"
          className="best"
          disabled={plan?.problems !== "" || !hasWork || refused > 0 || isWriting || isPending}
          onClick={() => plan && write(plan)}
        >
          {isWriting ? "Generating…" : isUpToDate ? "Up to date" : "Generate"}
        </button>
        {isPending && <span className="quiet">planning…</span>}
        <span>{message}</span>
      </header>
      <Fault>{fault || error || plan?.problems || ""}</Fault>
      {(refused > 0 || force) && (
        <label className="confirm">
          <input
            type="checkbox"
            checked={force}
            onChange={(event) => setForce(event.currentTarget.checked)}
          />{" "}
          Overwrite generated files that were edited by hand; a copy of each stays beside it.
          Nothing is generated while a file is refused.
        </label>
      )}
      {plan && plan.problems === "" && (
        <>
          {plan.drift.length > 0 && <Drift plan={plan} />}
          <Files plan={plan} file={file} force={force} shown={shown} onShow={setShown} />
          {isThere && (
            <>
              <p className="quiet">Run what was generated in a terminal:</p>
              <Copyable label="the command" text={`jausml run ${quoted(plan.out)}`} />
            </>
          )}
        </>
      )}
    </section>
  );
}

function Drift({ plan }: { plan: Plan }) {
  return (
    <div className="drift">
      <h2>Your files that no longer fit the model</h2>
      <ul>
        {plan.drift.map((finding) => (
          <li key={`${finding.path} ${finding.line} ${finding.message}`}>
            <Level level={finding.severity} /> {finding.path}
            {finding.line > 0 && `:${finding.line}`}: {finding.message}
            {finding.stub && <pre>{finding.stub}</pre>}
          </li>
        ))}
      </ul>
    </div>
  );
}

interface FilesProps {
  plan: Plan;
  file: string;
  force: boolean;
  /** The file whose diff is shown, empty for none. */
  shown: string;
  onShow: (path: string) => void;
}

function Files({ plan, file, force, shown, onShow }: FilesProps) {
  return (
    <div>
      {ACTIONS.map(([action, name, note]) => {
        const files = plan.files.filter((planned) => planned.action === action);
        if (files.length === 0) return null;
        const isOpen = WRITTEN.includes(action) || action === "refuse";
        return (
          <details key={action} open={isOpen} className={`plan-${action}`}>
            <summary>
              {files.length} {name} {note && <span className="quiet">{note}</span>}
            </summary>
            <ul>
              {files.map((planned) => (
                <li key={planned.path}>
                  <button
                    type="button"
                    className="link"
                    aria-expanded={shown === planned.path}
                    onClick={() => onShow(shown === planned.path ? "" : planned.path)}
                  >
                    {planned.path}
                  </button>{" "}
                  <small className="quiet">{planned.reason}</small>
                  {shown === planned.path && (
                    <FileDiff plan={plan} file={file} force={force} path={planned.path} />
                  )}
                </li>
              ))}
            </ul>
          </details>
        );
      })}
    </div>
  );
}

interface DiffProps {
  plan: Plan;
  file: string;
  force: boolean;
  path: string;
}

function FileDiff({ plan, file, force, path }: DiffProps) {
  const { value, error } = useAnswer("diff", { file, out: plan.out, path, force }, plan.digest);
  if (error) return <Fault>{error}</Fault>;
  if (value === null) return <Quiet>Comparing…</Quiet>;
  return value.diff === "" ? (
    <Quiet>Nothing of it would change.</Quiet>
  ) : (
    <Diff text={value.diff} />
  );
}
