import { useLayoutEffect, useRef, useState } from "react";
import { change } from "../../actions";
import { useOnceReady, useSettled, useTrying } from "../../answers";
import type { ConnectOption, ConnectResult, GraphEnd } from "../../protocol";
import { Fault } from "../base/parts";
import { useAnswer } from "../base/useAnswer";

const PAUSE_MS = 150;

interface Props {
  file: string;
  view: string;
  target: GraphEnd;
  revision: number;
  onDone: () => void;
}

/** Fills a member without a source: with a constant or the present time; or leaves it out. */
export function Fill({ file, view, target, revision, onDone }: Props) {
  const [typed, setTyped] = useState("");
  const [fault, attempt] = useTrying();
  const field = useRef<HTMLInputElement>(null);
  const value = useSettled(typed, PAUSE_MS);
  const answer = useAnswer("fill", { file, view, target, value }, revision);
  const proposals = answer.value;
  const [constant] = proposals?.constant.options ?? [];
  const isJudged = value === typed && proposals !== null;

  // It was asked for by a key or a button just now.
  useLayoutEffect(() => field.current?.focus(), []);

  const take = ({ commands, label }: ConnectOption) =>
    attempt(async () => {
      await change(commands, `Fill ${target.port}: ${label}`, proposals?.revision);
      onDone();
    });

  const takeConstant = useOnceReady(isJudged, () => constant && void take(constant));

  return (
    <form
      className="fill bar"
      aria-label={`Fill ${target.port}`}
      onSubmit={(event) => {
        event.preventDefault();
        takeConstant(true);
      }}
      onKeyDown={(event) => {
        if (event.key !== "Escape") return;
        event.stopPropagation();
        onDone();
      }}
    >
      <strong>{target.port}</strong>
      <label>
        {"= "}
        <input
          ref={field}
          type="text"
          aria-label="Constant"
          autoComplete="off"
          value={typed}
          onChange={(event) => {
            setTyped(event.currentTarget.value);
            takeConstant(false);
          }}
        />
      </label>
      <button type="submit" disabled={isJudged && !constant}>
        Set constant
      </button>
      <Way way={proposals?.clock} onTake={take} />
      <Way way={proposals?.ignore} onTake={take} />
      <button type="button" onClick={onDone}>
        Cancel
      </button>
      <Fault>{fault || answer.error || (typed && proposals?.constant.refusal) || ""}</Fault>
    </form>
  );
}

interface WayProps {
  way: ConnectResult | undefined;
  onTake: (option: ConnectOption) => void;
}

function Way({ way, onTake }: WayProps) {
  return way?.options.map((option) => (
    <button type="button" key={option.label} title={option.preview} onClick={() => onTake(option)}>
      {option.label}
    </button>
  ));
}
