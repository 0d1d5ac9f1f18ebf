import { type FormEvent, useId, useState } from "react";
import { newModel } from "../actions";
import type { StartingPoint } from "../protocol";
import { useStudio } from "../store";
import { Modal } from "./Modal";

const EMPTY: StartingPoint = { name: "empty", kind: "plain", about: "nothing" };

const KINDS = { plain: "Plain", profile: "Profiles", example: "Examples" };

interface Props {
  /** What it may begin with, null until that is known. */
  points: StartingPoint[] | null;
  onClose(): void;
}

/** A new model: its name, what it begins with, and how it is written. */
export function NewModel({ points, onClose }: Props) {
  const files = useStudio((studio) => studio.project?.files);
  const [name, setName] = useState("robot");
  const [origin, setOrigin] = useState(EMPTY);
  const [ending, setEnding] = useState<"ros2jaus" | "xmi">("ros2jaus");
  const about = useId();
  const isTextOnly = origin.kind !== "plain";
  const file = `${name.trim()}.${isTextOnly ? "ros2jaus" : ending}`;
  const isTaken = files?.some((other) => other.path === file) ?? false;
  function onSubmit(event: FormEvent) {
    event.preventDefault();
    if (isTaken || !name.trim()) return;
    onClose();
    void newModel(file, origin.name);
  }
  return (
    <Modal title="New model" onClose={onClose}>
      <form onSubmit={onSubmit} className="new-model">
        <label>
          Name{" "}
          <input
            spellCheck="false"
            value={name}
            onFocus={(event) => event.currentTarget.select()}
            onChange={(event) => setName(event.currentTarget.value)}
          />
        </label>
        <label>
          Begin with{" "}
          <select
            value={origin.name}
            aria-describedby={about}
            onChange={(event) => {
              const chosen = event.currentTarget.value;
              setOrigin(points?.find((point) => point.name === chosen) ?? EMPTY);
            }}
          >
            <Points points={points ?? [EMPTY]} />
          </select>
        </label>
        <p id={about}>
          {sentence(origin.about)}{" "}
          {origin.kind === "profile" && "What only a person can decide will be among the problems."}
        </p>
        <fieldset>
          <legend>Written as</legend>
          <label>
            <input
              type="radio"
              name="ending"
              checked={isTextOnly || ending === "ros2jaus"}
              onChange={() => setEnding("ros2jaus")}
            />{" "}
            text (.ros2jaus), to be read and typed
          </label>
          <label>
            <input
              type="radio"
              name="ending"
              disabled={isTextOnly}
              checked={!isTextOnly && ending === "xmi"}
              onChange={() => setEnding("xmi")}
            />{" "}
            XMI (.xmi), as Eclipse keeps it
          </label>
        </fieldset>
        {isTaken && <p role="alert">There is a {file} already.</p>}
        <footer>
          <button type="submit" className="best" disabled={isTaken || !name.trim()}>
            Create {file}
          </button>
        </footer>
      </form>
    </Modal>
  );
}

function Points({ points }: { points: StartingPoint[] }) {
  return Object.entries(KINDS).map(([kind, title]) => (
    <optgroup key={kind} label={title}>
      {points
        .filter((point) => point.kind === kind)
        .map((point) => (
          <option key={point.name} value={point.name}>
            {point.name}
          </option>
        ))}
    </optgroup>
  ));
}

const sentence = (about: string) => `${about.charAt(0).toUpperCase()}${about.slice(1)}.`;
