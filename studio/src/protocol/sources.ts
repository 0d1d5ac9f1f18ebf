// Texts of elements.

/** Where an element stands: units of UTF-16, with one for each end of a line. */
export interface Source {
  file: string;
  notation: "xmi" | "text";
  start: number;
  end: number;
  line: number;
  revision: number;
}

export interface FileText {
  text: string;
  revision: number;
  editable: boolean;
}
