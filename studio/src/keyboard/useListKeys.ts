import { type KeyboardEvent, useState } from "react";

/**
 * Up and down go round a list whose focus stays in one field, Enter takes what is active.
 *
 * @param count How many there are to choose among.
 * @param onTake Is told the position that was taken.
 */
export function useListKeys(count: number, onTake: (at: number) => void) {
  const [at, setActive] = useState(0);
  /** Position of what is active, -1 in an empty list. */
  const active = Math.min(at, count - 1);

  /** Takes a key of the field; false for one that means nothing to the list. */
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
