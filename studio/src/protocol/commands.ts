// Commands: what a user wants changed.

import type { LayoutKey, Point, Ref } from "./project";

export interface Child {
  feature: string;
  kind: string;
  values: Record<string, string[]>;
  children?: Child[];
}

export interface SetCommand {
  kind: "set";
  element: Ref;
  feature: string;
  values: string[];
}

export interface AddCommand {
  kind: "add";
  owner: Ref;
  feature: string;
  /** Qualified class; named `type` since `kind` names the command. */
  type: string;
  values: Record<string, string[]>;
  children?: Child[];
  position?: number | null;
}

export interface RemoveCommand {
  kind: "remove";
  element: Ref;
}

export interface MoveCommand {
  kind: "move";
  element: Ref;
  owner: Ref;
  feature: string;
  position?: number | null;
}

export interface RenameCommand {
  kind: "rename";
  element: Ref;
  name: string;
}

export interface CreateCommand {
  kind: "create";
  file: string;
  type: string;
  values: Record<string, string[]>;
}

export interface PlaceCommand {
  kind: "place";
  file: string;
  view: string;
  /** null forgets: the layout decides again. */
  positions: Record<LayoutKey, Point | null>;
}

export type Command =
  | SetCommand
  | AddCommand
  | RemoveCommand
  | MoveCommand
  | RenameCommand
  | CreateCommand
  | PlaceCommand;

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
  entry?: Entry | null;
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
