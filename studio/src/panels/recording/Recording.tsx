import { useEffect, useState } from "react";
import { ask, messageOf } from "../../actions";
import { isTyping } from "../../keyboard/keys";
import { useStudio } from "../../store";
import { Fault, Quiet } from "../base/parts";
import { Components, Connections } from "../live/Live";
import { close, goTo, look, open, player, put, stepToDrop, usePlayer } from "./player";
import { TimeLine } from "./TimeLine";
import { Why } from "./Why";
import "./recording.css";

const TICK_MS = 250;

/** A recording in the picture and the tables of the live view, at a moment that one chooses. */
export default function Recording() {
  const { name, read, share, fault } = usePlayer();
  const [files, setFiles] = useState<string[]>([]);
  const [unlisted, setUnlisted] = useState("");
  useEffect(() => {
    ask("recording.files", {}).then(
      (answer) => {
        setFiles(answer.files);
        const [first] = answer.given;
        if (first && !player().name && !player().fault) void open(first);
      },
      (error) => setUnlisted(messageOf(error)),
    );
  }, []);
  useKeys();
  return (
    <section className="live recording" aria-label="Recording">
      <header className="bar">
        <label>
          Recording
          <select
            value={name}
            onChange={(event) =>
              event.currentTarget.value ? void open(event.currentTarget.value) : close()
            }
          >
            <option value="">none: what runs</option>
            {files.map((file) => (
              <option key={file}>{file}</option>
            ))}
          </select>
        </label>
        {read && <Moves />}
      </header>
      <Fault>{fault || unlisted}</Fault>
      {!name && (
        <Quiet>
          {files.length > 0
            ? "Choose a file of jausml record: it is shown in the diagram as what runs is."
            : "The folder has no recording; jausml record makes one, and --recording names others."}
        </Quiet>
      )}
      {name && !read && !fault && (
        <p>
          Reading {name}: <progress value={share} aria-label={`Reading ${name}`} />
        </p>
      )}
      {read && <Shown />}
    </section>
  );
}

/** The keys of the whole page while this panel is open. */
function useKeys() {
  useEffect(() => {
    function onKeyDown(event: KeyboardEvent) {
      const step = { "[": -1, "]": 1 }[event.key] as 1 | -1 | undefined;
      const target = event.composedPath()[0];
      const isLine = target instanceof HTMLInputElement && target.type === "range";
      if (!step || event.ctrlKey || event.metaKey || (isTyping(event) && !isLine)) return;
      event.preventDefault();
      stepToDrop(step);
    }
    document.addEventListener("keydown", onKeyDown);
    return () => document.removeEventListener("keydown", onKeyDown);
  }, []);
}

/** Play, and the steps from drop to drop. */
function Moves() {
  const { isPlaying, read } = usePlayer();
  useEffect(() => {
    if (!isPlaying) return;
    let before = performance.now();
    const timer = setInterval(() => {
      const now = performance.now();
      const at = player().at + (now - before) / 1000;
      before = now;
      goTo(at);
      if (at >= (player().read?.duration ?? 0)) put({ isPlaying: false });
    }, TICK_MS);
    return () => {
      clearInterval(timer);
      put({ isPlaying: false });
    };
  }, [isPlaying]);
  const hasNone = !read?.marks.some((mark) => mark.kind === "drop");
  return (
    <>
      <button type="button" aria-pressed={isPlaying} onClick={() => put({ isPlaying: !isPlaying })}>
        {isPlaying ? "Pause" : "Play"}
      </button>
      <button type="button" disabled={hasNone} title="[" onClick={() => stepToDrop(-1)}>
        Drop before
      </button>
      <button type="button" disabled={hasNone} title="]" onClick={() => stepToDrop(1)}>
        Next drop
      </button>
    </>
  );
}

function Shown() {
  const { name, read, at, chosen } = usePlayer();
  const live = useStudio((studio) => studio.live);
  const file = useStudio((studio) => studio.file);
  const revision = useStudio((studio) => studio.revision);
  // biome-ignore lint/correctness/useExhaustiveDependencies: another model, or another revision of it
  useEffect(() => void look(), [file, revision]);
  if (!read) return null;
  const open = chosen ? `${chosen.bridge}/${chosen.connection}` : "";
  function choose(connection: string) {
    const traced = live?.connections?.find(
      (other) => `${other.bridge}/${other.connection}` === connection,
    );
    put({ chosen: traced ? { bridge: traced.bridge, connection: traced.connection } : null });
  }
  return (
    <>
      <TimeLine label={`Moment of ${name}`} read={read} at={at} onAt={goTo} />
      <Limits />
      <Why />
      <Connections connections={live?.connections ?? []} open={open} onOpen={choose} />
      <Components components={live?.components ?? []} />
    </>
  );
}

/** What the recording does not tell. */
function Limits() {
  const read = usePlayer((player) => player.read);
  const limits = [
    read?.damage ?? "",
    ...Object.values(read?.sources ?? {}),
    read?.unreadable ? `${read.unreadable} messages could not be read` : "",
    read?.unlisted ? `${read.unlisted} further changes are not marked` : "",
  ].filter(Boolean);
  if (limits.length === 0) return null;
  return (
    <p className="badge" role="note">
      ! {limits.join("; ")}.
    </p>
  );
}
