import { type KeyboardEvent, type PointerEvent, useEffect, useState } from "react";
import type { RightTab } from "./store";

/** Widths and heights of what stands around the diagram, in pixels. */
export interface Sizes {
  left: number;
  /** The right side has one for fields and one for texts, which need more. */
  form: number;
  source: number;
  bottom: number;
  isFolded: boolean;
}

const SIDES = ["left", "form", "source", "bottom"] as const;
type Side = (typeof SIDES)[number];

const USUAL: Sizes = { left: 240, form: 330, source: 480, bottom: 240, isFolded: false };
const LEAST = 120;
const STEP = 24;
const KEY = "jausml-sizes";

/** Returns what was kept of sizes, the usual ones in place of what makes no sense. */
export function keptSizes(storage: Storage): Sizes {
  let kept: Partial<Sizes> = {};
  try {
    kept = (JSON.parse(storage.getItem(KEY) ?? "{}") ?? {}) as Partial<Sizes>;
  } catch {
    // What nobody can read is as good as nothing.
  }
  const size = (side: Side) => {
    const value = kept[side];
    return [side, typeof value === "number" && value >= LEAST ? value : USUAL[side]];
  };
  const sides = Object.fromEntries(SIDES.map(size)) as Record<Side, number>;
  return { ...sides, isFolded: kept.isFolded === true };
}

/** Sizes that are remembered, and what changes them. */
export function useSizes(): [Sizes, (change: Partial<Sizes>) => void] {
  const [sizes, setSizes] = useState(() => keptSizes(localStorage));
  useEffect(() => localStorage.setItem(KEY, JSON.stringify(sizes)), [sizes]);
  return [sizes, (change) => setSizes((before) => ({ ...before, ...change }))];
}

/** The rows and columns of the page, for its style sheet. */
export function asProperties(sizes: Sizes, right: RightTab): Record<string, string> {
  return {
    "--left": `${sizes.left}px`,
    "--right": `${sizes[right]}px`,
    // Folded, the tabs remain.
    "--bottom": sizes.isFolded ? "34px" : `${sizes.bottom}px`,
  };
}

/** Keys that make it smaller and larger. */
const KEYS = {
  left: ["ArrowLeft", "ArrowRight"],
  right: ["ArrowRight", "ArrowLeft"],
  bottom: ["ArrowDown", "ArrowUp"],
};

interface Props {
  side: Side;
  label: string;
  size: number;
  onSize: (size: number) => void;
  /** Folds or unfolds what it stands before; where that is possible. */
  onFold?: (() => void) | undefined;
}

/** A border that is moved by mouse or arrow keys. */
export function Splitter({ side, label, size, onSize, onFold }: Props) {
  const place = side === "left" || side === "bottom" ? side : "right";
  const isFlat = side === "bottom";
  const most = Math.max(LEAST, Math.round((isFlat ? window.innerHeight : window.innerWidth) * 0.7));
  const set = (value: number) => onSize(Math.min(most, Math.max(LEAST, Math.round(value))));

  function onPointerDown(event: PointerEvent<HTMLHRElement>) {
    const bar = event.currentTarget;
    const start = isFlat ? event.clientY : event.clientX;
    event.preventDefault();
    bar.setPointerCapture(event.pointerId);
    bar.onpointermove = (moved) => {
      const way = (isFlat ? moved.clientY : moved.clientX) - start;
      set(size + (side === "left" ? way : -way));
    };
    bar.onpointerup = () => {
      bar.onpointermove = null;
    };
  }

  function onKeyDown(event: KeyboardEvent) {
    const [less, more] = KEYS[place];
    if (event.key === more) set(size + STEP);
    else if (event.key === less) set(size - STEP);
    else if (event.key === "Enter" && onFold) onFold();
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  return (
    <hr
      className={`splitter splitter-${place}`}
      aria-label={label}
      aria-orientation={isFlat ? "horizontal" : "vertical"}
      aria-valuenow={size}
      aria-valuemin={LEAST}
      aria-valuemax={most}
      tabIndex={0}
      onPointerDown={onPointerDown}
      onDoubleClick={onFold}
      onKeyDown={onKeyDown}
    />
  );
}
