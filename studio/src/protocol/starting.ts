// What a new model may begin with.

export interface StartingPoint {
  name: string;
  /** Those that are not plain are text only. */
  kind: "plain" | "profile" | "example";
  /** Half a sentence on what it has. */
  about: string;
}
