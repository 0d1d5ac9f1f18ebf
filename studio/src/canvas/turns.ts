// Work of many parts that is spread over pictures of the screen, so that none of them stalls.

import { useEffect, useLayoutEffect, useState } from "react";

/** So many parts change at once; further ones wait for the next picture. */
const AT_ONCE = 80;

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

/** What React Flow is given: a box, or a frame. */
interface Shown {
  id: string;
  hidden?: boolean;
}

/** So many boxes and frames come at once, and so many go. */
export const BOXES_AT_ONCE = 30;

/** Returns boxes and frames of which few come or go with one picture of the screen; at first all. */
export function useFewAtOnce<T extends Shown>(wanted: T[]): T[] {
  const [at, setAt] = useState({ wanted, shown: wanted });
  // What is wanted may change several times before the next picture, which takes one step alone.
  const now = at.wanted === wanted ? at : { wanted, shown: further(at.shown, wanted, 0) };
  if (now !== at) setAt(now);
  const { shown } = now;
  useEffect(() => {
    if (shown === wanted) return;
    const next = requestAnimationFrame(() =>
      setAt((at) => ({ ...at, shown: further(at.shown, at.wanted) })),
    );
    return () => cancelAnimationFrame(next);
  }, [shown, wanted]);
  return shown;
}

/**
 * Returns what is shown next, of which `most` come and go, on the way to what is wanted.
 *
 * What goes is hidden before it is taken away: React Flow throws and catches an error, with all that
 * led to it, for each part that is gone while it is drawn.
 */
export function further<T extends Shown>(shown: T[], wanted: T[], most = BOXES_AT_ONCE): T[] {
  if (shown.length === wanted.length && shown.every((part, at) => part.id === wanted[at]?.id))
    return wanted;
  const before = new Set(shown.map((part) => part.id));
  const after = new Set(wanted.map((part) => part.id));
  let [coming, going] = [most, most];
  const staying = wanted.filter(({ id }) => before.has(id) || coming-- > 0);
  const leaving = shown
    .filter((part) => !after.has(part.id) && !part.hidden)
    .map((part) => (going-- > 0 ? { ...part, hidden: true } : part));
  return staying.length === wanted.length && !leaving.length ? wanted : [...staying, ...leaving];
}
