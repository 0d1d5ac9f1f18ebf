import { diff } from "@codemirror/merge";
import { ChangeSet, type ChangeSpec } from "@codemirror/state";

interface Replaced {
  from: number;
  to: number;
  insert: string;
}

/** Returns what makes one text of another, as small changes. */
function changesBetween(old: string, fresh: string): Replaced[] {
  return diff(old, fresh).map((change) => ({
    from: change.fromA,
    to: change.toA,
    insert: fresh.slice(change.fromB, change.toB),
  }));
}

function touch(left: Replaced, right: Replaced): boolean {
  return left.from <= right.to && right.from <= left.to;
}

/**
 * Brings a change of others into a text that has changed too.
 *
 * @param base The text that both began with.
 * @param own What it became here.
 * @param theirs What it became elsewhere.
 * @returns Changes of `own`; null when both changed the same place in different ways.
 */
export function merged(base: string, own: string, theirs: string): ChangeSpec | null {
  if (own === theirs) return [];
  const there = changesBetween(base, theirs);
  if (own === base) return there;
  const here = changesBetween(base, own);
  if (here.some((left) => there.some((right) => touch(left, right)))) return null;
  return ChangeSet.of(there, base.length).map(ChangeSet.of(here, base.length));
}
