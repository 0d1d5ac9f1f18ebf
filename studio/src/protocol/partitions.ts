// Which bridges there are, and which connections each carries.

import type { Command } from "./commands";

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
