// Maps: their members, and values that are tried.

import type { Command } from "./commands";

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
