// Files of a project, how their elements are named, and what is wrong, written and generated.

import type { Severity } from "./graphs";

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
  /** Recordings that the studio was started with. */
  recordings?: string[];
}

export interface ViewInfo {
  name: string;
  kind: "system" | "map" | "service" | "machine";
  title: string;
  library: boolean;
}

interface Child {
  feature: string;
  kind: string;
  values: Record<string, string[]>;
  children?: Child[];
}

/** What a user wants changed; the class of what is added is qualified. */
export type Command =
  | { kind: "set"; element: Ref; feature: string; values: string[] }
  | ({ kind: "add"; owner: Ref; type: string; position?: number | null } & Omit<Child, "kind">)
  | { kind: "remove"; element: Ref }
  | { kind: "move"; element: Ref; owner: Ref; feature: string; position?: number | null }
  | { kind: "rename"; element: Ref; name: string }
  | { kind: "create"; file: string; type: string; values: Record<string, string[]> }
  /** A place that is null is forgotten: the layout decides again. */
  | { kind: "place"; file: string; view: string; positions: Record<LayoutKey, Point | null> };

export interface Entry {
  number: number;
  label: string;
  files: string[];
  created: Ref[];
}

/** An edit that met a change beneath it: kept until it is done again or discarded. */
export interface KeptEdit {
  number: number;
  label: string;
  commands: Command[];
  why: string;
}

export interface Referrer {
  element: Ref;
  label: string;
}

/** Where a box shall stand: its upper left corner in a view. */
export interface Corner {
  file: string;
  view: string;
  x: number;
  y: number;
}

export interface EditResult {
  revision: number;
  created: Ref[];
  diff?: string;
  referrers?: Referrer[];
}

/** What a text says that was pasted, and nothing here can stand for. */
export interface LeftOut {
  /** The element that says it, empty where it has no name. */
  name: string;
  message: string;
}

export interface Cure {
  label: string;
  commands: Command[];
}

export interface Problem {
  file: string;
  line: number;
  column: number;
  severity: Severity;
  rule: string;
  message: string;
  hint: string;
  element: Ref | "";
  /** Element path by names. */
  path: string;
  cures: Cure[];
}

/** A fault of the studio itself. */
export interface LoggedFault {
  /** Seconds since 1970. */
  time: number;
  level: string;
  text: string;
  details: string;
}

export interface Problems {
  revision: number;
  /** Why no rules were run, empty when they were. */
  fault?: string;
  elapsed_ms: number;
  problems: Problem[];
}

export type PlanAction = "create" | "change" | "keep" | "same" | "remove" | "refuse";

export interface Plan {
  out: string;
  files: { path: string; action: PlanAction; reason: string }[];
  drift: { path: string; line: number; severity: Severity; message: string; stub: string }[];
  problems: string;
  digest: string;
}

/** Where an element stands: units of UTF-16, with one for each end of a line. */
export interface Source {
  file: string;
  notation: "xmi" | "text";
  start: number;
  end: number;
}

export interface FileText {
  text: string;
  revision: number;
  editable: boolean;
}

/** An element in the outline; one without an element tells how many more there are. */
export interface OutlineRow {
  element: Ref | "";
  label: string;
  kind: string;
  depth: number;
  /** How many elements it owns. */
  inner: number;
  is_open: boolean;
  /** What owns it, where that is not above it. */
  note: string;
}
