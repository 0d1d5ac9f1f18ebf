// What the page knows, in one store; what it does with it stands in actions.ts.

import { create } from "zustand";
import type { Link } from "./connection";
import type {
  ChosenStep,
  Command,
  ConnectOption,
  Freshness,
  Graph,
  GraphEnd,
  KeptEdit,
  LayoutKey,
  LegalEnd,
  LiveState,
  OutsideChange,
  Point,
  Problems,
  Project,
  Ref,
  Referrer,
  StartingPoint,
  ViewInfo,
} from "./protocol";
import type { PartKey } from "./selection";

/** A dialog that is open; one at a time. */
export type Dialog =
  | { kind: "help" }
  | { kind: "operate" }
  | { kind: "create"; points: StartingPoint[] | null }
  | {
      kind: "delete";
      commands: Command[];
      label: string;
      /** Null while they are looked for. */
      referrers: Referrer[] | null;
      diff: string;
      /** Revision of which the refs are. */
      base: number;
    }
  /** Ends, ways to connect and names are null while they are looked for. */
  | { kind: "ends"; from: GraphEnd; ends: LegalEnd[] | null }
  | {
      kind: "connect";
      source: GraphEnd;
      target: GraphEnd;
      options: ConnectOption[] | null;
      refusal: string;
      revision?: number;
    }
  | { kind: "hosts"; boxes: string[] }
  | { kind: "bridges"; elements: Ref[] }
  | { kind: "partition" }
  | { kind: "rename"; element: Ref; name: string | null; base: number }
  | { kind: "diff"; title: string; diff: string };

/** Something that another program did to a file. */
export interface Outside extends OutsideChange {
  isConflict: boolean;
}

/** What was typed into a field that is not shown now, and could not be taken. */
export interface Draft {
  /** Empty where it is of none. */
  element: Ref | "";
  /** Feature and which of its values; one draft for each. */
  field: string;
  /** How people call the field. */
  what: string;
  text: string;
  why: string;
}

/** How far the corner of the diagram is moved, and how large all is. */
export type Sight = [x: number, y: number, zoom: number];

/** A path through the machine of a view, and where it has come to. */
export interface Walk {
  file: string;
  view: string;
  path: ChosenStep[];
  said: Record<string, boolean>;
  /** Path of the present state, empty while it is asked for. */
  at: string;
  /** Id of the transition that led there. */
  by: string;
}

export type BottomTab = "problems" | "generate" | "live" | "recording" | "step" | "log";
export type MiddleTab = "diagram" | "table" | "members";
type LeftTab = "palette" | "outline";
export type RightTab = "form" | "source";

/** What it knows at first. */
export const BEGINNING = {
  link: "opening" as Link,
  refusal: "",
  project: null as Project | null,
  file: "",
  views: [] as ViewInfo[],
  view: "",
  /** How often a view was opened: it may be renamed while one looks at it. */
  visits: 0,
  graph: null as Graph | null,
  /** Revision that the graph shows. */
  revision: 0,
  /** Number of the picture that the graph is, 0 where the server has none of it. */
  picture: 0,
  /** Whether its findings are those of its revision. */
  isChecked: true,
  /** Keys of the frames that are shown with what is in them. */
  opened: [] as LayoutKey[],
  /** Where one looks, null for the whole. */
  sight: null as Sight | null,
  /** Counts how often the whole was to be shown. */
  fits: 0,
  /** The middle of what shall be seen next. */
  centre: null as Point | null,
  /** What the graph is worth, null where nothing was said of it. */
  freshness: null as Freshness | null,
  /** Why there is no graph, empty if there is one. */
  graphFault: "",
  /** Selected parts of the graph, the last one is where the keyboard stands. */
  selection: [] as PartKey[],
  /** The element that forms and sources show; it need not be part of the graph. */
  chosen: "" as Ref | "",
  /** Counts what was chosen: it stays when only the ref of what is chosen becomes another. */
  choice: 0,
  problems: null as Problems | null,
  live: null as LiveState | null,
  /** The recording whose moment stands in the place of what runs; empty for none. */
  recorded: "",
  dialog: null as Dialog | null,
  /** The part whose name is being edited in place; the name is null while it is asked for. */
  renaming: null as { key: PartKey; element: Ref; name: string | null; base: number } | null,
  /** How many edits that change names are under way. */
  renames: 0,
  outside: [] as Outside[],
  /** Edits that were not done since others have changed the same. */
  kept: [] as KeptEdit[],
  drafts: [] as Draft[],
  /** When the live state came: milliseconds of a clock that nobody sets. */
  liveAt: 0,
  said: { text: "", isError: false },
  /** What was copied, where the clipboard of the system does not take it. */
  clip: "",
  /** Parts that stay bright while all others fade; null without a focus. */
  bright: null as Set<PartKey> | null,
  /** Ends to which the line that is being drawn may go. */
  legal: null as Set<PartKey> | null,
  /** The part that would take what is being dragged. */
  under: null as PartKey | null,
  filter: "",
  /** The machine that is stepped, null while none is. */
  walk: null as Walk | null,
  bottom: "problems" as BottomTab,
  left: "palette" as LeftTab,
  middle: "diagram" as MiddleTab,
  right: "form" as RightTab,
};

export type Studio = typeof BEGINNING;

/** `useStudio(state => state.graph)` in components, `useStudio.getState()` elsewhere. */
export const useStudio = create<Studio>(() => BEGINNING);

export const state = (): Studio => useStudio.getState();
export const update = (change: Partial<Studio>): void => useStudio.setState(change);

/** Tells the user something, which screen readers speak. */
export function say(text: string, isError = false): void {
  update({ said: { text, isError } });
}

/** Revision of what `chosen` names: that of the graph, which brings the names of the new one along. */
export function revisionOf(studio: Studio): number {
  return studio.graph ? studio.revision : (studio.project?.revision ?? 0);
}

/** Revision of the files, which is ahead of that of the graph while this is made. */
export const useRevision = (): number => useStudio((studio) => studio.project?.revision ?? 0);

/** Where the keyboard stands. */
export function active(studio: Studio): PartKey | null {
  return studio.selection.at(-1) ?? null;
}

/** The walk that the diagram shows: where the machine runs elsewhere is another thing. */
function shownWalk(studio: Studio): Walk | null {
  const { walk, file, view, bottom } = studio;
  return bottom === "step" && walk?.file === file && walk.view === view ? walk : null;
}

/** Tells whether a box or frame shows the state in which a stepped machine is, or one around it. */
export function isPresent(studio: Studio, id: string, isAround = false): boolean {
  const at = shownWalk(studio)?.at;
  const path = id.slice(id.lastIndexOf("!") + 1);
  return Boolean(at) && (path === at || (isAround && at!.startsWith(`${path}.`)));
}

/** Tells whether a line shows the transition that a stepped machine took last. */
export function isTakenLast(studio: Studio, id: string): boolean {
  return shownWalk(studio)?.by === id;
}
