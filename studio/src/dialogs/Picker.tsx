import { type KeyboardEvent, type ReactNode, useEffect, useId, useRef, useState } from "react";

export interface Pick {
  id: string;
  /** What is searched. */
  text: string;
  shown: ReactNode;
}

interface Props {
  label: string;
  picks: Pick[];
  onPick(at: number): void;
  isSearched?: boolean;
}

/** A list to choose one of, searched as one types; arrows go, Enter takes. */
export function Picker({ label, picks, onPick, isSearched = true }: Props) {
  const [typed, setTyped] = useState("");
  const [at, setAt] = useState(0);
  const id = useId();
  const list = useRef<HTMLDivElement>(null);
  const words = typed.toLowerCase().split(/\s+/).filter(Boolean);
  const shown = picks
    .map((pick, index) => ({ pick, index }))
    .filter(({ pick }) => words.every((word) => pick.text.toLowerCase().includes(word)));
  const here = Math.min(at, shown.length - 1);

  useEffect(() => {
    list.current?.querySelector(`[data-at="${here}"]`)?.scrollIntoView({ block: "nearest" });
  }, [here]);

  function onKeyDown(event: KeyboardEvent) {
    const to = { ArrowDown: here + 1, ArrowUp: here - 1, Home: 0, End: shown.length - 1 }[
      event.key
    ];
    if (to !== undefined && !(isSearched && ["Home", "End"].includes(event.key))) {
      event.preventDefault();
      setAt(Math.max(0, Math.min(to, shown.length - 1)));
    } else if (event.key === "Enter") {
      event.preventDefault();
      const found = shown[here];
      if (found) onPick(found.index);
    }
  }

  const active = shown[here] ? `${id}-${here}` : undefined;
  return (
    <div className="picker">
      {isSearched && (
        <input
          type="search"
          role="combobox"
          aria-label={`Search ${label}`}
          aria-expanded
          aria-controls={id}
          aria-activedescendant={active}
          spellCheck={false}
          value={typed}
          onChange={(event) => {
            setTyped(event.currentTarget.value);
            setAt(0);
          }}
          onKeyDown={onKeyDown}
        />
      )}
      <div
        id={id}
        ref={list}
        role="listbox"
        aria-label={label}
        tabIndex={isSearched ? -1 : 0}
        aria-activedescendant={isSearched ? undefined : active}
        onKeyDown={isSearched ? undefined : onKeyDown}
      >
        {shown.map(({ pick, index }, row) => (
          // biome-ignore lint/a11y/useKeyWithClickEvents: keys go to the list
          // biome-ignore lint/a11y/useFocusableInteractive: the list has the focus
          <div
            key={pick.id}
            id={`${id}-${row}`}
            data-at={row}
            role="option"
            aria-selected={row === here}
            onClick={() => onPick(index)}
            onPointerMove={() => setAt(row)}
          >
            {pick.shown}
          </div>
        ))}
        {shown.length === 0 && <p className="quiet">Nothing fits.</p>}
      </div>
    </div>
  );
}
