import { type FocusEvent, useReducer, useRef, useState } from "react";

/** A list whose entries keep their places. */
export interface StillList<T> {
  /** The entries in their places, each as it is now, or as it was when it went. */
  shown: T[];
  /** The number of entries that wait until nobody is at the list. */
  waiting: number;
  isGone: (entry: T) => boolean;
  /** What the element around the list takes. */
  hand: object;
}

/**
 * Keeps the places of a list while somebody is at it with a pointer, or with keys at one of its
 * buttons: a press would find another entry than the one that was aimed at.
 */
export function useStill<T>(current: T[], keyOf: (entry: T) => unknown): StillList<T> {
  const element = useRef<HTMLElement>(null);
  const [isUnderPointer, setUnderPointer] = useState(false);
  const [, renderAgain] = useReducer((count: number) => count + 1, 0);
  const places = useRef(current);
  // Asked now, as a button that goes while it has the focus says nothing of losing it.
  const isTouched = isUnderPointer || element.current?.querySelector("button:focus-visible");
  if (!isTouched) places.current = current;
  const present = new Map(current.map((entry) => [keyOf(entry), entry]));
  places.current = places.current.map((entry) => present.get(keyOf(entry)) ?? entry);
  const shown = places.current;
  return {
    shown,
    waiting: current.length - shown.filter((entry) => present.has(keyOf(entry))).length,
    isGone: (entry) => !present.has(keyOf(entry)),
    hand: {
      ref: element,
      onPointerEnter: () => setUnderPointer(true),
      onPointerLeave: () => setUnderPointer(false),
      // A press takes the focus from a field of the list before it reaches its button.
      onBlur: ({ relatedTarget }: FocusEvent) => {
        if (!element.current?.contains(relatedTarget as Node | null)) renderAgain();
      },
    },
  };
}
