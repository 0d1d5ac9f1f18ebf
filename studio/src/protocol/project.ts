// Files of a project, and how their elements are named.

/** `<file>#<fragment>` of an element of a model; valid for one revision of the project. */
export type Ref = string;

/** Name path of an element, such as `bridge:main/velocity`; positions of boxes are kept by it. */
export type LayoutKey = string;

export type Point = [number, number];

export interface FileInfo {
  path: string;
  notation: "xmi" | "text";
  /** The model is the last one that could be read. */
  stale: boolean;
  /** The text cannot be parsed at the moment. */
  dirty: boolean;
}

/** What an answer is worth. */
export interface Freshness {
  /** Generating and verdicts take `current` alone. */
  state: "current" | "stale" | "unreadable" | "conflict";
  /** Revision of which the answer is; null where the files never could be read. */
  since: number | null;
  /** What keeps it from being current, for people. */
  why: string;
}

export interface Project {
  name: string;
  root: string;
  revision: number;
  files: FileInfo[];
  /** The file to show first, empty for none. */
  opened: string;
  /** Whether there is something to undo, or to do again. */
  undoable: boolean;
  redoable: boolean;
  extras: { live: boolean; recordings?: string[] };
}

export type ViewKind = "system" | "map" | "service" | "machine";

export interface ViewInfo {
  name: string;
  kind: ViewKind;
  title: string;
  library: boolean;
}
