// What is selected, which element forms and sources show, and which parts stand out.

import { following, matching, type Stream } from "../canvas/following";
import type { Ref } from "../protocol";
import { elementOf, indexOf, nameOf, type PartKey } from "../selection";
import { say, state, update } from "../store";
import { ask, tried } from "./asking";
import { openFile } from "./showing";

/** Selects parts of the graph; the last one is shown in the form. */
export function select(selection: PartKey[]): void {
  const { graph } = state();
  const last = selection.at(-1);
  take(graph && last ? elementOf(graph, last) : "", selection);
}

/** Shows an element in form and source, and selects it where the graph has it. */
export function choose(element: Ref): void {
  const { graph } = state();
  const key = graph ? indexOf(graph).byElement.get(element) : undefined;
  take(element, key ? [key] : []);
  if (element && graph?.folded && !key) void lookAt(element);
}

/** Brings what stands in a closed frame into sight, by which it is opened. */
async function lookAt(element: Ref): Promise<void> {
  const { file, view } = state();
  const { place } = (await tried(ask("where", { file, view, element }))) ?? {};
  if (place && state().chosen === element && state().view === view) update({ centre: place });
}

function take(chosen: Ref | "", selection: PartKey[]): void {
  const before = state();
  const choice = chosen === before.chosen ? before.choice : before.choice + 1;
  update({ selection, chosen, choice });
}

/** Shows an element in the file where it stands, whichever file is shown now. */
export async function reveal(element: Ref, file: string): Promise<void> {
  if (
    file &&
    file !== state().file &&
    state().project?.files.some((other) => other.path === file)
  ) {
    await openFile(file);
  }
  choose(element);
}

/** The elements that are selected, or those of some parts, and how to call them. */
export function selected(keys = state().selection): { elements: Ref[]; what: string } {
  const { graph } = state();
  if (!graph) return { elements: [], what: "" };
  const known = keys.filter((key) => elementOf(graph, key));
  const elements = [...new Set(known.map((key) => elementOf(graph, key)))];
  const name = known[0] ? nameOf(graph, known[0]) : "";
  return { elements, what: elements.length === 1 ? name : `${elements.length} elements` };
}

/** Lets only what has this text in its name stand out; an empty text lets all. */
export function filterBy(filter: string): void {
  const { graph } = state();
  update({ filter, bright: graph ? matching(graph, filter) : null });
}

/** Lets only what is up- or downstream of the choice stand out; null ends it. */
export function focusOn(stream: Stream | null): void {
  const { graph, selection } = state();
  if (!stream || !graph || !selection.length) return update({ bright: null, filter: "" });
  const bright = new Set(selection.flatMap((key) => [...following(graph, key, stream)]));
  update({ bright, filter: "" });
  say(
    `${bright.size} parts are ${{ up: "upstream", down: "downstream", both: "joined" }[stream]}.`,
  );
}
