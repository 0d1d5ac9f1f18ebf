import { type KeyboardEvent, useId, useRef, useState } from "react";
import { useOnceReady } from "../../answers";
import { useListKeys } from "../../keyboard/useListKeys";
import type { Choice, Ref } from "../../protocol";
import { revisionOf, useStudio } from "../../store";
import { useAnswer } from "./useAnswer";

const NONE: Choice[] = [];

interface Props {
  id?: string | undefined;
  label: string;
  /** The reference whose targets are offered. */
  element: Ref;
  feature: string;
  /** What is chosen, as it is shown. */
  shown: string;
  placeholder?: string | undefined;
  disabled?: boolean;
  isWrong?: boolean;
  describedBy?: string | undefined;
  onChoose: (value: string) => void;
}

/** A text field that offers what may be chosen, searched as one types (ARIA combobox). */
export function Combobox(props: Props) {
  const [query, setQuery] = useState<string | null>(null);
  const list = useId();
  const input = useRef<HTMLInputElement>(null);
  const isOpen = query !== null;
  const { element, feature } = props;
  const revision = useStudio(revisionOf);
  const asked = isOpen ? { element, feature, query } : null;
  const { value: choices, error } = useAnswer("choices", asked, revision);
  const offered = choices?.choices ?? NONE;
  const keys = useListKeys(offered.length, (at) => choose(offered[at]));
  const { active } = keys;

  const takeFirst = useOnceReady(Boolean(choices || error), () => choose(choices?.choices[0]));

  function close() {
    setQuery(null);
    takeFirst(false);
    keys.setActive(0);
  }

  function choose(choice: Choice | undefined) {
    if (choice === undefined) return;
    close();
    props.onChoose(choice.value);
  }

  function onKeyDown(event: KeyboardEvent) {
    if (isOpen && !choices && event.key === "Enter") {
      event.preventDefault();
      takeFirst(true);
      return;
    }
    if (isOpen && keys.onKey(event)) return;
    if (!isOpen && (event.key === "ArrowDown" || event.key === "ArrowUp")) {
      event.preventDefault();
      setQuery("");
    }
    if (event.key === "Escape" && isOpen) {
      event.stopPropagation();
      close();
    }
  }

  return (
    <div className="combobox">
      <input
        ref={input}
        id={props.id}
        role="combobox"
        aria-label={props.label}
        aria-expanded={isOpen}
        aria-controls={list}
        aria-autocomplete="list"
        aria-activedescendant={isOpen && offered.length > 0 ? `${list}-${active}` : undefined}
        aria-invalid={props.isWrong || undefined}
        aria-describedby={props.describedBy}
        autoComplete="off"
        spellCheck="false"
        disabled={props.disabled}
        placeholder={props.placeholder}
        value={query ?? props.shown}
        onFocus={(event) => event.currentTarget.select()}
        onClick={() => query === null && setQuery("")}
        onChange={(event) => {
          setQuery(event.currentTarget.value);
          takeFirst(false);
          keys.setActive(0);
        }}
        onBlur={close}
        onKeyDown={onKeyDown}
      />
      <div className="options" hidden={!isOpen}>
        <div id={list} role="listbox" aria-label={props.label}>
          {isOpen &&
            offered.map((choice, index) => (
              // biome-ignore lint/a11y/useFocusableInteractive: the focus stays in the input, which names the active one
              // biome-ignore lint/a11y/useKeyWithClickEvents: keys are those of the input
              <div
                key={choice.value}
                id={`${list}-${index}`}
                role="option"
                aria-selected={index === active}
                ref={(element) => {
                  if (index === active) element?.scrollIntoView?.({ block: "nearest" });
                }}
                // Before the input loses the focus, which would close the list.
                onMouseDown={(event) => event.preventDefault()}
                onClick={() => choose(choice)}
              >
                <span>{choice.label}</span>
                {choice.documentation && (
                  <small className="documentation">{choice.documentation}</small>
                )}
              </div>
            ))}
        </div>
        {isOpen && offered.length === 0 && (
          <p className="quiet">{error || (choices ? "Nothing has this name." : "Looking…")}</p>
        )}
        {choices && choices.more > 0 && (
          <p className="quiet">{choices.more} more; type to find them.</p>
        )}
      </div>
    </div>
  );
}
