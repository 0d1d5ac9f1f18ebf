import { useLayoutEffect, useState } from "react";
import { ask } from "../../actions";
import { useTrying } from "../../answers";
import type { ChosenStep, Stepping as Standing, StepChoice } from "../../protocol";
import { revisionOf, update, useStudio, type Walk } from "../../store";
import { Copyable, Fault, figure, Quiet } from "../base/parts";
import { useAnswer } from "../base/useAnswer";

const KINDS = [
  ["message", "Messages"],
  ["event", "Internal events"],
  ["core", "Core services"],
  ["time", "Time"],
] as const;

/** The machine of the view, stepped by hand: what can happen, what has happened, and a test of it. */
export function Stepping() {
  const file = useStudio((studio) => studio.file);
  const view = useStudio((studio) => studio.view);
  const revision = useStudio(revisionOf);
  const known = useStudio((studio) => studio.walk);
  const walk: Walk =
    known?.file === file && known.view === view
      ? known
      : { file, view, path: [], said: {}, at: "", by: "" };
  const { path, said } = walk;
  const answer = useAnswer("step", { file, view, path, said }, revision, `${file} ${view}`);
  const standing = answer.value;
  const go = (change: Partial<Walk>) => update({ walk: { ...walk, ...change } });

  const by = standing?.taken.at(-1)?.transition ?? "";
  // At once, before a click changes the walk that is told of here.
  // biome-ignore lint/correctness/useExhaustiveDependencies: an answer says where the path leads
  useLayoutEffect(() => {
    if (standing) go({ at: standing.state, by });
  }, [standing?.state, by]);

  if (answer.error) return <Fault>{answer.error}</Fault>;
  if (standing === null) return <Quiet>Asking where the machine begins…</Quiet>;
  return (
    <section className="stepping" aria-label="Step" aria-busy={answer.isPending}>
      <Where standing={standing} said={said} onSay={(text) => go({ said: text })} />
      <Choices
        standing={standing}
        onChoose={({ actor, what }) => go({ path: [...path, { actor, what, said }] })}
      />
      <Taken standing={standing} path={path} onBack={(to) => go({ path: path.slice(0, to) })} />
      <AsTest key={JSON.stringify(path)} file={file} view={view} path={path} />
    </section>
  );
}

interface WhereProps {
  standing: Standing;
  said: Record<string, boolean>;
  onSay: (said: Record<string, boolean>) => void;
}

/** The present state, and what conditions of the user say: nobody but a person knows that. */
function Where({ standing, said, onSay }: WhereProps) {
  return (
    <div>
      <h2>{standing.component} is in</h2>
      <p aria-live="polite">
        <strong>{standing.state}</strong>
        <br />
        {standing.status},{" "}
        {standing.controller ? `controlled by ${standing.controller}` : "not controlled"}
      </p>
      {standing.conditions.length > 0 && (
        <fieldset>
          <legend>Your conditions say</legend>
          {standing.conditions.map((name) => (
            <label key={name}>
              <input
                type="checkbox"
                checked={said[name] ?? false}
                onChange={(event) => onSay({ ...said, [name]: event.currentTarget.checked })}
              />{" "}
              {name}
              <br />
            </label>
          ))}
        </fieldset>
      )}
      {standing.beside.length > 0 && (
        <Quiet>{`${standing.beside.join(", ")} may act meanwhile, and is not stepped.`}</Quiet>
      )}
    </div>
  );
}

interface ChoicesProps {
  standing: Standing;
  onChoose: (choice: StepChoice) => void;
}

function Choices({ standing, onChoose }: ChoicesProps) {
  const [isAll, setAll] = useState(false);
  const shown = standing.choices.filter((choice) => isAll || !choice.why_not);
  return (
    <div>
      <label>
        <input
          type="checkbox"
          checked={isAll}
          onChange={(event) => setAll(event.currentTarget.checked)}
        />{" "}
        also what has no effect
      </label>
      {KINDS.map(([kind, title]) => {
        const offered = shown.filter((choice) => choice.kind === kind);
        if (offered.length === 0) return null;
        return (
          <div key={kind}>
            <h2>{title}</h2>
            <ul className="choices">
              {offered.map((choice) => (
                <li key={`${choice.actor} ${choice.what}`}>
                  <button type="button" onClick={() => onChoose(choice)}>
                    {nameOf(choice, standing.tick)}
                  </button>{" "}
                  <span className="quiet">{choice.why_not || leads(choice, standing.state)}</span>
                </li>
              ))}
            </ul>
          </div>
        );
      })}
    </div>
  );
}

interface TakenProps {
  standing: Standing;
  path: ChosenStep[];
  onBack: (to: number) => void;
}

function Taken({ standing, path, onBack }: TakenProps) {
  return (
    <div>
      <h2>What has happened</h2>
      <button type="button" disabled={path.length === 0} onClick={() => onBack(path.length - 1)}>
        Back
      </button>{" "}
      <button type="button" disabled={path.length === 0} onClick={() => onBack(0)}>
        Begin again
      </button>
      <Fault>{standing.fault}</Fault>
      <ol>
        {standing.taken.map((choice, at) => (
          // biome-ignore lint/suspicious/noArrayIndexKey: steps have no other name
          <li key={at}>
            <button
              type="button"
              className="link"
              title="Go back to here"
              onClick={() => onBack(at + 1)}
            >
              {nameOf(choice, standing.tick)}
            </button>{" "}
            <span className="quiet">{choice.why_not || last(choice.state)}</span>
          </li>
        ))}
      </ol>
    </div>
  );
}

/** The path as a test that runs beside the generated workspace. */
function AsTest({ file, view, path }: { file: string; view: string; path: ChosenStep[] }) {
  const [test, setTest] = useState("");
  const [fault, attempt] = useTrying();
  const make = () =>
    attempt(async () => setTest((await ask("step.test", { file, view, path })).test));

  return (
    <>
      <div>
        <button type="button" disabled={path.length === 0} onClick={make}>
          Make a test of it
        </button>
        <Fault>{fault}</Fault>
      </div>
      {test && <TestText text={test} />}
    </>
  );
}

function TestText({ text }: { text: string }) {
  return (
    <>
      <Copyable label="the test" text="Copy it into a file test_path.py" copied={text} />
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: it is scrolled by keys */}
      <pre tabIndex={0}>{text}</pre>
    </>
  );
}

/** How people call a step. */
export function nameOf(step: StepChoice, tick: number): string {
  if (step.kind === "time") return `${figure(tick)} s pass`;
  return step.kind === "event" || step.what === "fails"
    ? step.what
    : `${step.what} of ${step.actor}`;
}

function leads(choice: StepChoice, from: string): string {
  return choice.state === from ? "stays" : `→ ${last(choice.state)}`;
}

/** The names of a path that tell states apart: its last two. */
function last(path: string): string {
  return path.split(".").slice(-2).join(".");
}
