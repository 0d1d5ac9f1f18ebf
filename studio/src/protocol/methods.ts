// Requests and notifications.

import type { GraphEnd, ViewResult } from "./graphs";
import type * as live from "./live";
import type * as offers from "./offers";
import type * as project from "./project";
import type { Command, LayoutKey, Point, Ref } from "./project";

/** Requests: parameters and results by method. */
export interface Methods {
  hello: [{ token: string }, project.Project];
  views: [{ file: string }, { views: project.ViewInfo[] }];
  view: [{ file: string; view: string; opened: LayoutKey[]; base: number }, ViewResult];
  /** The whole view as SVG, as `jausml diagram` draws it. */
  picture: [{ file: string; view: string }, { picture: string }];
  /** Where the box of an element stands, whether it is shown or not. */
  where: [{ file: string; view: string; element: Ref }, { place: Point | null }];
  arrange: [{ file: string; view: string; opened: LayoutKey[] }, ViewResult];
  edit: [
    { commands: Command[]; label: string; base?: number; dry?: boolean; at?: project.Corner },
    project.EditResult,
  ];
  undo: [Record<string, never>, { revision: number; entry: project.Entry | null }];
  redo: [Record<string, never>, { revision: number; entry: project.Entry | null }];
  log: [Record<string, never>, { entries: project.Entry[]; at: number }];
  kept: [Record<string, never>, { edits: project.KeptEdit[] }];
  "kept.again": [{ number: number }, project.EditResult];
  "kept.discard": [{ number: number }, unknown];
  /** What went wrong in the studio itself, the latest first. */
  faults: [Record<string, never>, { faults: project.LoggedFault[] }];
  starting_points: [Record<string, never>, { points: offers.StartingPoint[] }];
  /** Makes a model file that begins with a starting point. */
  create: [{ file: string; origin: string }, project.EditResult];
  copy: [{ elements: Ref[] }, { text: string }];
  paste: [{ owner: Ref; text: string }, project.EditResult & { left_out: project.LeftOut[] }];
  form: [{ element: Ref }, offers.Form];
  /** What a reference may lead to, the best fits of a search; `more` is how many there are beside. */
  choices: [
    { element: Ref; feature: string; query: string },
    { choices: offers.Choice[]; more: number },
  ];
  palette: [
    /** `onto` is the element that it is added to, or dropped on. */
    { file: string; query: string; kinds?: string[]; limit?: number; onto?: Ref },
    { items: offers.PaletteItem[]; revision?: number },
  ];
  connect: [
    { file: string; view: string; source: GraphEnd; target: GraphEnd },
    offers.ConnectResult,
  ];
  ends: [{ file: string; view: string; node: string; port: string }, { ends: offers.LegalEnd[] }];
  /** What lets boxes run on a host, given by the id of its frame; empty for outside of all. */
  host: [{ file: string; nodes: string[]; host: string }, offers.ConnectOption];
  /** Bridges as they are proposed, or with the bridge of some connections by their names. */
  partition: [
    { file: string; most: number; load: number; names?: Record<string, string> },
    offers.Partition,
  ];
  /** What moves connections to a bridge, empty for a new one; `why` tells what goes along. */
  carry: [{ file: string; elements: Ref[]; bridge: Ref | "" }, offers.ConnectOption];
  /** What bridges cost, by the ids of their boxes. */
  loads: [{ file: string }, { loads: Record<string, string> }];
  /** How a line is taken away that is no element. */
  unlink: [{ file: string; line: string }, offers.ConnectResult];
  problems: [{ file: string }, project.Problems];
  source: [{ element: Ref }, project.Source];
  text: [{ file: string }, project.FileText];
  /** The innermost element whose text has the character at an offset of a file. */
  at: [{ file: string; offset: number }, { element: Ref | "" }];
  /** All elements of a file as a tree, of which the inside of some is told, or what a search finds. */
  outline: [{ file: string; query: string; opened: Ref[] }, { rows: project.OutlineRow[] }];
  members: [{ file: string; view: string }, { sides: offers.MapSide[] }];
  /** How a member of a map may be filled without a source. */
  fill: [
    { file: string; view: string; target: GraphEnd; value: string },
    {
      constant: offers.ConnectResult;
      clock: offers.ConnectResult;
      ignore: offers.ConnectResult;
      revision?: number;
    },
  ];
  /** What nothing fills yet in a map, and what corresponds to it. */
  fill_map: [{ file: string; view: string }, offers.Filling];
  write: [{ file: string; text: string; base: number }, { revision: number }];
  try: [
    { file: string; map: string; direction: offers.Direction; values: Record<string, string> },
    offers.TryResult,
  ];
  tried: [
    { file: string; map: string; direction: offers.Direction },
    { inputs: offers.TriedInput[] },
  ];
  step: [
    { file: string; view: string; path: live.ChosenStep[]; said: Record<string, boolean> },
    live.Stepping,
  ];
  /** A path as a test module. */
  "step.test": [{ file: string; view: string; path: live.ChosenStep[] }, { test: string }];
  /** `force` overwrites generated files that were edited, after a copy. */
  plan: [{ file: string; out?: string; force?: boolean }, project.Plan];
  diff: [{ file: string; out: string; path: string; force: boolean }, { diff: string }];
  generate: [
    { file: string; out: string; digest: string; force: boolean },
    { written: number; message: string },
  ];
  "live.start": [{ file: string }, unknown];
  "live.stop": [Record<string, never>, unknown];
  "live.message": [{ connection: string }, live.LiveMessage];
  /** `given` are those that the studio was started with. */
  "recording.files": [Record<string, never>, { files: string[]; given: string[] }];
  /** Reads it from the first question on; `share` is how much is read, up to 1. */
  "recording.open": [
    { recording: string },
    { share: number; fault: string; read: live.ReadRecording | null },
  ];
  "recording.state": [
    { recording: string; file: string; at: number },
    { at: number; state: live.LiveState },
  ];
  "recording.why": [
    { recording: string; file: string; bridge: string; connection: string; at: number },
    live.Explanation,
  ];
}

export type Method = keyof Methods;
export type Params<M extends Method> = Methods[M][0];
export type Result<M extends Method> = Methods[M][1];

/** Notifications of the server: parameters by method. */
export interface Notifications {
  changed: {
    revision: number;
    files: project.FileInfo[];
    by: "edit" | "outside";
    undoable: boolean;
    redoable: boolean;
  };
  problems: project.Problems;
  /** Another program changed a file while there were changes here that it does not have. */
  conflict: OutsideChange;
  /** Another program changed a file. */
  outside: OutsideChange;
  live: { state: live.LiveState };
  /** The edits that are kept have changed. */
  kept: { edits: project.KeptEdit[] };
}

export interface OutsideChange {
  file: string;
  diff: string;
  /** Whether the file is there no more. */
  gone: boolean;
}

export type Notification = keyof Notifications;
