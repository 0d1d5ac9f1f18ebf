// Which parts stand out.

import { following, matching, type Stream } from "../canvas/following";
import { say, state, update } from "../store";

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
