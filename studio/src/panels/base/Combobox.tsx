import { type KeyboardEvent, useId, useMemo, useRef, useState } from "react";
import { useListKeys } from "../../keyboard/useListKeys";
import type { Choice } from "../../protocol";

const MOST_SHOWN = 100;

interface Props {
  id?: string | undefined;
  label: string;
  choices: readonly Choice[];
  /** What is chosen, as it is shown. */
  shown: string;
  placeholder?: string | undefined;
  disabled?: boolean;
  isWrong?: boolean;
  describedBy?: string | undefined;
  onChoose: (value: string) => void;
}

/** Returns the choices that hold all words of a query; those that begin with it come first. */
export function matching(choices: readonly Choice[], query: string): Choice[] {
  const words = query.toLowerCase().split(/\s+/).filter(Boolean);
  const found = choices.filter((each) => {
    const text = `${each.label} ${each.value}`.toLowerCase();
    return words.every((word) => text.includes(word));
  });
  const first = query.trim().toLowerCase();
  const weight = (each: Choice) => (each.label.toLowerCase().startsWith(first) ? 0 : 1);
  return first ? found.sort((left, right) => weight(left) - weight(right)) : found;
}

/** A text field that offers what may be chosen, searched as one types (ARIA combobox). */
export function Combobox(props: Props) {
  const [query, setQuery] = useState<string | null>(null);
  const list = useId();
  const input = useRef<HTMLInputElement>(null);
  const isOpen = query !== null;
  const all = useMemo(() => matching(props.choices, query ?? ""), [props.choices, query]);
  const offered = all.slice(0, MOST_SHOWN);
  const keys = useListKeys(offered.length, (at) => choose(offered[at]));
  const { active } = keys;

  function close() {
    setQuery(null);
    keys.setActive(0);
  }

  function choose(choice: Choice | undefined) {
    if (choice === undefined) return;
    close();
    props.onChoose(choice.value);
  }

  function onKeyDown(event: KeyboardEvent) {
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
        spellCheck={false}
        disabled={props.disabled}
        placeholder={props.placeholder}
        value={query ?? props.shown}
        onFocus={(event) => event.currentTarget.select()}
        onClick={() => query === null && setQuery("")}
        onChange={(event) => {
          setQuery(event.currentTarget.value);
          keys.setActive(0);
        }}
        onBlur={close}
        onKeyDown={onKeyDown}
      />
      <div className="options" id={list} role="listbox" aria-label={props.label} hidden={!isOpen}>
        {isOpen &&
          offered.map((each, index) => (
            // biome-ignore lint/a11y/useFocusableInteractive: the focus stays in the input, which names the active one
            // biome-ignore lint/a11y/useKeyWithClickEvents: keys are those of the input
            <div
              key={each.value}
              id={`${list}-${index}`}
              role="option"
              aria-selected={index === active}
              ref={(element) => {
                if (index === active) element?.scrollIntoView?.({ block: "nearest" });
              }}
              // Before the input loses the focus, which would close the list.
              onMouseDown={(event) => event.preventDefault()}
              onClick={() => choose(each)}
            >
              <span>{each.label}</span>
              {each.documentation && <small>{each.documentation}</small>}
            </div>
          ))}
        {isOpen && offered.length === 0 && <p className="quiet">Nothing has this name.</p>}
        {isOpen && all.length > MOST_SHOWN && (
          <p className="quiet">{all.length - MOST_SHOWN} more; type to find them.</p>
        )}
      </div>
    </div>
  );
}
