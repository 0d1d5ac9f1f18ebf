import { type KeyboardEvent, useState } from "react";

/** Where the keyboard stands in a list whose focus stays in one field. */
export interface ListKeys {
  /** Position of what is active, -1 in an empty list. */
  active: number;
  setActive: (at: number) => void;
  /** Takes a key of the field; false for one that means nothing to the list. */
  onKey: (event: KeyboardEvent) => boolean;
}

/**
 * Up and down go round a list, Enter takes what is active.
 *
 * @param count How many there are to choose among.
 * @param onTake Is told the position that was taken.
 */
export function useListKeys(count: number, onTake: (at: number) => void): ListKeys {
  const [at, setActive] = useState(0);
  const active = Math.min(at, count - 1);

  function onKey(event: KeyboardEvent): boolean {
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (step === undefined && event.key !== "Enter") return false;
    event.preventDefault();
    if (!count) return true;
    if (step === undefined) onTake(active);
    else setActive((active + step + count) % count);
    return true;
  }

  return { active, setActive, onKey };
}
