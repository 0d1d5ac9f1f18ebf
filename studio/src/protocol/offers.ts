// What may be changed, added and connected: forms, the palette, lines, maps, bridges.

import type { Command, Ref } from "./project";

type FieldKind = "text" | "multiline" | "number" | "integer" | "boolean" | "choice" | "reference";

export interface Choice {
  value: string;
  label: string;
  documentation: string;
}

export interface FormField {
  feature: string;
  label: string;
  kind: FieldKind;
  many: boolean;
  required: boolean;
  /** What it is about, above fields that are about the same; empty for what it is. */
  group: string;
  values: string[];
  /** Labels of references. */
  shown: string[];
  default: string;
  documentation: string;
  unit: string;
  /** Those of a reference are asked for when its list is opened. */
  choices: Choice[];
  problems: string[];
  changeable: boolean;
}

export interface ChildKind {
  kind: string;
  label: string;
  documentation: string;
  /** What a new one begins with, such as a name that nobody has. */
  values?: Record<string, string[]>;
}

export interface FormChild {
  element: Ref;
  label: string;
  kind: string;
  /** What is read and changed of it where it is listed. */
  cells?: FormField[];
}

export interface FormChildren {
  feature: string;
  label: string;
  many: boolean;
  documentation: string;
  kinds: ChildKind[];
  elements: FormChild[];
}

export interface Form {
  element: Ref;
  class: string;
  title: string;
  documentation: string;
  readonly: boolean;
  owner: Ref | "";
  fields: FormField[];
  children: FormChildren[];
}

export type PaletteGroup = "components" | "services" | "ros types" | "ready maps" | "elements";

export interface PaletteItem {
  id: string;
  group: PaletteGroup;
  label: string;
  note: string;
  documentation: string;
  commands: Command[];
  label_of_edit: string;
  /** What it is added to, empty for the system. */
  onto: string;
}

export interface ConnectOption {
  label: string;
  why: string;
  /** What it comes to, such as a statement; may be empty. */
  preview: string;
  commands: Command[];
  is_best: boolean;
  /** Revision of which the refs of its commands are. */
  revision?: number;
}

export interface ConnectResult {
  options: ConnectOption[];
  refusal: string;
  /** Revision of which the refs of its commands are. */
  revision?: number;
}

export interface LegalEnd {
  node: string;
  port: string;
  label: string;
  why: string;
}

export interface MapMember {
  path: string;
  label: string;
  /** Type, unit and range. */
  note: string;
  mark: string;
  depth: number;
}

/** All members of one end of a map; the graph has only those of interest. */
export interface MapSide {
  /** Id of the box in the graph. */
  node: string;
  members: MapMember[];
}

export type Direction = "to_ros" | "to_jaus";

/** What fills a map. */
export interface Filling {
  label: string;
  commands: Command[];
  /** Members that nothing fills then. */
  left: Partial<Record<Direction, string[]>>;
  refusal: string;
  /** Revision of which the refs of its commands are. */
  revision?: number;
}

export interface TriedInput {
  path: string;
  type: string;
  unit: string;
  default: string;
}

export interface TryResult {
  values: { path: string; value: string; unit: string }[];
  bytes: string;
  error: string;
  /** What was done to values that do not fit. */
  notes: string[];
}

export interface PlannedBridge {
  name: string;
  /** Empty where the system has no hosts. */
  host: string;
  /** Names of connections, each behind that of its bridge now. */
  connections: string[];
  processor_share: number;
  datagrams_per_s: number;
  bytes_between_hosts_per_s: number;
  /** Seconds that a message waits when one of each connection comes at once. */
  wait_s: number;
  reasons: string[];
}

export interface Partition {
  before: PlannedBridge[];
  after: PlannedBridge[];
  /** The new bridge of each connection that moves. */
  moved: Record<string, string>;
  /** What keeps it from being done; without commands then. */
  faults: string[];
  /** The limits that it does not hold. */
  excess: string[];
  commands: Command[];
  revision?: number;
}

export interface StartingPoint {
  name: string;
  /** Those that are not plain are text only. */
  kind: "plain" | "profile" | "example";
  /** Half a sentence on what it has. */
  about: string;
}
