import { useState } from "react";
import { useSettled } from "../../answers";
import type { Direction } from "../../protocol";
import { Copyable, Fault, Quiet } from "../base/parts";
import { useAnswer } from "../base/useAnswer";

const PAUSE_MS = 300;
const BYTES_A_LINE = 16;

interface Props {
  file: string;
  map: string;
  revision: number;
}

/** Values of one side to be typed, and what the generated translation makes of them. */
export function TryIt({ file, map, revision }: Props) {
  const [direction, setDirection] = useState<Direction | null>(null);
  return (
    <section className="try-it" aria-label="Try it">
      <header className="bar">
        <h2>Try it</h2>
        {(["to_ros", "to_jaus"] as const).map((entry) => (
          <button
            type="button"
            key={entry}
            aria-pressed={direction === entry}
            onClick={() => setDirection(direction === entry ? null : entry)}
          >
            {entry === "to_ros" ? "JAUS → ROS" : "ROS → JAUS"}
          </button>
        ))}
      </header>
      {direction === null ? (
        <Quiet>Choose a direction: the real translation is generated and run.</Quiet>
      ) : (
        <Trial key={direction} file={file} map={map} direction={direction} revision={revision} />
      )}
    </section>
  );
}

function Trial({ file, map, direction, revision }: Props & { direction: Direction }) {
  const question = { file, map, direction };
  const { value: asked, error } = useAnswer("tried", question, revision);
  const [typed, setTyped] = useState<Record<string, string>>({});
  const values = useSettled(typed, PAUSE_MS);
  const {
    value: result,
    error: fault,
    isPending,
  } = useAnswer("try", asked ? { ...question, values } : null, revision);

  if (error) return <Fault>{error}</Fault>;
  if (asked === null) return <Quiet>Generating the translation…</Quiet>;
  return (
    <div className="trial">
      <table>
        <caption>{direction === "to_ros" ? "JAUS message" : "ROS message"}</caption>
        <tbody>
          {asked.inputs.map((entry) => (
            <tr key={entry.path}>
              <th scope="row">{entry.path}</th>
              <td>
                <input
                  type="text"
                  aria-label={entry.path}
                  autoComplete="off"
                  spellCheck="false"
                  placeholder={entry.default}
                  value={typed[entry.path] ?? ""}
                  onChange={(event) => {
                    const { value } = event.currentTarget;
                    setTyped(({ [entry.path]: _, ...rest }) =>
                      value === "" ? rest : { ...rest, [entry.path]: value },
                    );
                  }}
                />
              </td>
              <td className="quiet">{entry.unit || entry.type}</td>
            </tr>
          ))}
          {asked.inputs.length === 0 && (
            <tr>
              <td className="quiet">Nothing is assigned this way.</td>
            </tr>
          )}
        </tbody>
      </table>
      <div className="trial-result" aria-busy={isPending} aria-live="polite">
        <Fault>{fault || result?.error || ""}</Fault>
        {result && !result.error && (
          <>
            <table>
              <caption>{direction === "to_ros" ? "ROS message" : "JAUS message"}</caption>
              <tbody>
                {result.values.map((value) => (
                  <tr key={value.path}>
                    <th scope="row">{value.path}</th>
                    <td>{value.value}</td>
                    <td className="quiet">{value.unit}</td>
                  </tr>
                ))}
              </tbody>
            </table>
            {result.notes.map((note) => (
              <p className="quiet" key={note}>
                {note}
              </p>
            ))}
            {result.bytes && <Bytes hex={result.bytes} />}
          </>
        )}
      </div>
    </div>
  );
}

/** Returns bytes as lines of pairs of digits. */
export function dumped(hex: string): string {
  const pairs = hex.replaceAll(/\s/g, "").match(/../g) ?? [];
  const count = Math.ceil(pairs.length / BYTES_A_LINE);
  return Array.from({ length: count }, (_, line) =>
    pairs.slice(line * BYTES_A_LINE, (line + 1) * BYTES_A_LINE).join(" "),
  ).join("\n");
}

function Bytes({ hex }: { hex: string }) {
  const text = dumped(hex);
  return (
    <div className="bytes">
      <span className="quiet">{hex.replaceAll(/\s/g, "").length / 2} bytes on the wire</span>
      {text.includes("\n") ? <pre>{text}</pre> : <Copyable label="the bytes" text={text} />}
    </div>
  );
}
