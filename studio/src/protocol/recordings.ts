// What the page is told of recordings.

/** Something that changed between two moments; times are seconds since the beginning. */
export interface Mark {
  kind: "drop" | "state" | "control";
  time: number;
  /** Bridge and connection; an address and nothing for a component. */
  bridge: string;
  connection: string;
}

/** A recording that is read. */
export interface ReadRecording {
  duration: number;
  /** What of the file cannot be read. */
  damage: string;
  /** Why it tells nothing of ROS, or of JAUS. */
  sources: Record<string, string>;
  unreadable: number;
  marks: Mark[];
  /** Marks that are too many to be listed. */
  unlisted: number;
}

export interface Explanation {
  /** The time that is explained: that of the last drop. */
  at: number;
  counter: string[];
  state: string[];
}
