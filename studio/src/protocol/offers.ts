// What may be changed, added and connected: forms, the palette, lines.

import type { Command } from "./commands";
import type { Ref } from "./project";

export type FieldKind =
  | "text"
  | "multiline"
  | "number"
  | "integer"
  | "boolean"
  | "choice"
  | "reference";

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
  drop: { commands: Command[] };
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
