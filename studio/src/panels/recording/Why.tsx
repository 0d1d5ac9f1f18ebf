import { useStudio } from "../../store";
import { Fault, Quiet } from "../base/parts";
import { useAnswer } from "../base/useAnswer";
import { goTo, put, usePlayer } from "./player";

/** Why a connection did not pass on what it dropped last: counter and state. */
export function Why() {
  const { name, at, chosen } = usePlayer();
  const file = useStudio((studio) => studio.file);
  const params = chosen && { recording: name, file, ...chosen, at };
  const subject = chosen ? `${name} ${file} ${chosen.bridge} ${chosen.connection}` : "";
  const { value, error } = useAnswer("recording.why", params, 0, subject);
  if (!chosen)
    return (
      <Quiet>
        Step to a drop, or choose a connection below: why it did not pass a message on stands here.
      </Quiet>
    );
  const title = `Why ${chosen.connection} of ${chosen.bridge} did not pass on a message`;
  return (
    <section className="why" aria-label={title}>
      <header className="bar">
        <h2>{title}</h2>
        {value && value.at !== at && (
          <button type="button" onClick={() => goTo(value.at)}>
            Go to {value.at.toFixed(1)} s
          </button>
        )}
        <button type="button" onClick={() => put({ chosen: null })}>
          Close
        </button>
      </header>
      <Fault>{error}</Fault>
      {value && (
        <>
          <h3>The counter</h3>
          <Sentences sentences={value.counter} />
          {value.state.length > 0 && <h3>The state</h3>}
          <Sentences sentences={value.state} />
        </>
      )}
    </section>
  );
}

function Sentences({ sentences }: { sentences: string[] }) {
  return (
    <>
      {sentences.map((sentence) => (
        <p key={sentence}>{sentence}</p>
      ))}
    </>
  );
}
