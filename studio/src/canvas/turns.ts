// Work of many parts that is spread over pictures of the screen, so that none of them stalls.

import { useLayoutEffect, useState } from "react";

/** So many parts change at once; further ones wait for the next picture. */
export const AT_ONCE = 80;

const waiting = new Map<() => void, number>();
let changed = 0;
let isBegun = false;

/** Returns what is wanted, as soon as it is the turn of this part (`parts`: how many change by it). */
export function useTurn(wanted: boolean, parts: number): boolean {
  const [has, setHas] = useState(false);
  useLayoutEffect(() => {
    if (wanted === has) return;
    const work = () => setHas(wanted);
    waiting.set(work, parts);
    takeTurns();
    return () => void waiting.delete(work);
  }, [wanted, has, parts]);
  return has;
}

/** Does as much as is done at once, and the rest with the next picture. */
function takeTurns(): void {
  for (const [work, parts] of waiting) {
    if (changed >= AT_ONCE) break;
    changed += parts;
    waiting.delete(work);
    work();
  }
  if (isBegun || !changed) return;
  isBegun = true;
  requestAnimationFrame(() => {
    isBegun = false;
    changed = 0;
    takeTurns();
  });
}
