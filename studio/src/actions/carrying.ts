// Which bridge carries which connections.

import type { Graph, Ref } from "../protocol";
import { elementOf, indexOf, nodeKey, partOf } from "../selection";
import { say, state, update } from "../store";
import { ask, tried } from "./asking";
import { take } from "./connecting";

/** Type of what rows of bridges give to a drag: the refs of connections as JSON. */
export const CARRIED = "application/x-jausml-connections";

/** The bridges of a graph. */
export const bridgesOf = (graph: Graph) => graph.nodes.filter((node) => node.kind === "bridge");

/** The connections among the chosen rows; with `row`, those that are dragged by it. */
export function carriedBy(row = ""): Ref[] {
  const { graph, selection } = state();
  if (!graph) return [];
  const keys = row && !selection.includes(row) ? [row] : selection;
  return keys.flatMap((key) => {
    const part = partOf(key);
    const isCarried = part.of === "port" && indexOf(graph).nodes.get(part.node)?.kind === "bridge";
    return isCarried ? elementOf(graph, key) || [] : [];
  });
}

/**
 * Moves connections to another bridge; where others have to go along, it asks first.
 *
 * @param bridge Id of the box, empty for a new bridge.
 */
export async function carry(elements: Ref[], bridge: string): Promise<void> {
  const { file, graph } = state();
  const to = bridge && graph ? elementOf(graph, nodeKey(bridge)) : "";
  const option = await tried(ask("carry", { file, elements, bridge: to }));
  if (!option?.commands.length) return;
  if (!option.why) return take(option, option.revision);
  const { revision } = option;
  const end = { node: bridge, port: "" };
  const asked = { source: end, target: end, options: [option], refusal: "" };
  update({ dialog: { kind: "connect", ...asked, ...(revision && { revision }) } });
}

/** Asks which bridge shall carry the chosen connections. */
export function offerBridges(): void {
  const elements = carriedBy();
  if (!elements.length) return say("Choose a connection of a bridge first.");
  update({ dialog: { kind: "bridges", elements } });
}
