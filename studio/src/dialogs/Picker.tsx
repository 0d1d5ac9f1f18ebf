import { type ReactNode, useEffect, useId, useRef, useState } from "react";
import { useOnceReady } from "../answers";
import { useListKeys } from "../keyboard/useListKeys";

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
  /** Whether there may be more to choose soon; Enter waits for it. */
  isLooking?: boolean;
  /** What stands below the list, of the one that Enter takes. */
  details?: (at: number) => ReactNode;
}

/** A list to choose one of, searched as one types; arrows go, Enter takes. */
export function Picker({
  label,
  picks,
  onPick,
  isSearched = true,
  isLooking = false,
  details,
}: Props) {
  const [typed, setTyped] = useState("");
  const id = useId();
  const list = useRef<HTMLDivElement>(null);
  const words = typed.toLowerCase().split(/\s+/).filter(Boolean);
  const shown = picks
    .map((pick, index) => ({ pick, index }))
    .filter(({ pick }) => words.every((word) => pick.text.toLowerCase().includes(word)));
  const keys = useListKeys(shown.length, (at) => {
    const choice = shown[at];
    if (choice) onPick(choice.index);
  });
  const here = keys.active;

  useEffect(() => {
    list.current?.querySelector(`[data-at="${here}"]`)?.scrollIntoView({ block: "nearest" });
  }, [here]);

  const takeFirst = useOnceReady(!isLooking, () => shown[0] && onPick(shown[0].index));

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
          spellCheck="false"
          value={typed}
          onChange={(event) => {
            setTyped(event.currentTarget.value);
            keys.setActive(0);
            takeFirst(false);
          }}
          onKeyDown={(event) => {
            if (event.key === "Enter" && isLooking) takeFirst(true);
            else keys.onKey(event);
          }}
        />
      )}
      <div
        id={id}
        ref={list}
        role="listbox"
        aria-label={label}
        tabIndex={isSearched ? -1 : 0}
        aria-activedescendant={isSearched ? undefined : active}
        onKeyDown={isSearched ? undefined : keys.onKey}
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
            onPointerMove={() => keys.setActive(row)}
          >
            {pick.shown}
          </div>
        ))}
      </div>
      {shown[here] && details?.(shown[here].index)}
      {shown.length === 0 && <p className="quiet">{isLooking ? "Looking…" : "Nothing fits."}</p>}
    </div>
  );
}
