import { useEffect, useState } from "react";
import { ask, messageOf } from "../../actions";
import type { Plan, PlanAction } from "../../protocol";
import { say, useStudio } from "../../store";
import { Copyable, Fault, Quiet } from "../base/parts";
import { useRevision } from "../base/studio";
import { useAnswer } from "../base/useAnswer";
import { Diff } from "./Diff";

const ACTIONS: [PlanAction, string, string][] = [
  ["refuse", "refused", "edited by hand; it stays as it is"],
  ["create", "created", ""],
  ["change", "changed", ""],
  ["remove", "removed", ""],
  ["keep", "kept", "yours; written once and never again"],
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
  const {
    value: plan,
    error,
    isPending,
    again,
  } = useAnswer("plan", file ? planned(file, out) : null, revision);
  const [shown, setShown] = useState("");
  const [message, setMessage] = useState("");
  const [fault, setFault] = useState("");
  const [isAsking, setAsking] = useState(false);
  const [isWriting, setWriting] = useState(false);

  // What was said holds for the plan that it was said about.
  // biome-ignore lint/correctness/useExhaustiveDependencies: a new plan
  useEffect(() => setAsking(false), [plan?.digest]);

  if (!file) return <Quiet>No file is open.</Quiet>;

  async function write(taken: Plan) {
    setAsking(false);
    setWriting(true);
    setFault("");
    try {
      const done = await ask("generate", { file, out: taken.out, digest: taken.digest });
      setMessage(done.message);
      say(done.message);
    } catch (error) {
      setFault(messageOf(error));
    } finally {
      setWriting(false);
      again();
    }
  }

  const refused = plan?.files.filter((each) => each.action === "refuse") ?? [];
  const isUpToDate = plan !== null && !plan.files.some((each) => WRITTEN.includes(each.action));
  return (
    <section className="generate" aria-label="Generate">
      <header>
        <label>
          Folder{" "}
          <input
            type="text"
            value={typed || out}
            placeholder={plan?.out ?? ""}
            onChange={(event) => setTyped(event.currentTarget.value)}
            onBlur={() => setOut(typed.trim())}
            onKeyDown={(event) => event.key === "Enter" && setOut(typed.trim())}
          />
        </label>
        <button
          type="button"
          className="primary"
          disabled={plan === null || plan.problems !== "" || isUpToDate || isWriting}
          onClick={() => plan && (refused.length > 0 ? setAsking(true) : write(plan))}
        >
          {isWriting ? "Generating…" : isUpToDate ? "Up to date" : "Generate"}
        </button>
        {isPending && <span className="quiet">planning…</span>}
        <span>{message}</span>
      </header>
      <Fault>{fault || error || plan?.problems || ""}</Fault>
      {isAsking && plan && (
        <div className="confirm" role="alertdialog" aria-label="Files that are refused">
          <p>
            {refused.length === 1 ? "One file was" : `${refused.length} files were`} edited by hand
            and will stay as {refused.length === 1 ? "it is" : "they are"}. Generate the others?
          </p>
          <button type="button" onClick={() => write(plan)}>
            Generate the others
          </button>{" "}
          <button type="button" onClick={() => setAsking(false)}>
            Cancel
          </button>
        </div>
      )}
      {plan && (
        <>
          {plan.drift.length > 0 && (
            <div className="drift">
              <h4>Your files that no longer fit the model</h4>
              <ul>
                {plan.drift.map((each) => (
                  <li key={each}>{each}</li>
                ))}
              </ul>
            </div>
          )}
          <Files plan={plan} file={file} shown={shown} onShow={setShown} />
          <p className="quiet">Run what was generated in a terminal:</p>
          <Copyable label="the command" text={`jausml run ${quoted(plan.out)}`} />
        </>
      )}
    </section>
  );
}

function planned(file: string, out: string) {
  return out === "" ? { file } : { file, out };
}

interface FilesProps {
  plan: Plan;
  file: string;
  /** The file whose diff is shown, empty for none. */
  shown: string;
  onShow: (path: string) => void;
}

function Files({ plan, file, shown, onShow }: FilesProps) {
  return (
    <div className="plan">
      {ACTIONS.map(([action, name, note]) => {
        const files = plan.files.filter((each) => each.action === action);
        if (files.length === 0) return null;
        const isOpen = WRITTEN.includes(action) || action === "refuse";
        return (
          <details key={action} open={isOpen} className={`plan-${action}`}>
            <summary>
              {files.length} {name} {note && <span className="quiet">{note}</span>}
            </summary>
            <ul>
              {files.map((each) => (
                <li key={each.path}>
                  <button
                    type="button"
                    className="link"
                    aria-expanded={shown === each.path}
                    onClick={() => onShow(shown === each.path ? "" : each.path)}
                  >
                    {each.path}
                  </button>{" "}
                  <small className="quiet">{each.reason}</small>
                  {shown === each.path && <FileDiff plan={plan} file={file} path={each.path} />}
                </li>
              ))}
            </ul>
          </details>
        );
      })}
    </div>
  );
}

function FileDiff({ plan, file, path }: { plan: Plan; file: string; path: string }) {
  const { value, error } = useAnswer("diff", { file, out: plan.out, path }, plan.digest);
  if (error) return <Fault>{error}</Fault>;
  if (value === null) return <Quiet>Comparing…</Quiet>;
  return value.diff === "" ? (
    <Quiet>Nothing of it would change.</Quiet>
  ) : (
    <Diff text={value.diff} />
  );
}
