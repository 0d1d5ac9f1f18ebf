// Texts of elements.

import type { Ref } from "./project";

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
