// Files and their views: which of them is shown.

import { matching } from "../canvas/following";
import { CallError, INTERNAL_ERROR, LOST } from "../connection";
import type { Freshness, Graph } from "../protocol";
import { carriedOver, elementOf } from "../selection";
import { state, update } from "../store";
import { ask, messageOf, tried } from "./asking";

/** Shows a file, at a view of it or at its first. */
export async function openFile(file: string, view = ""): Promise<void> {
  if (!file) return update({ file, views: [], view: "", graph: null, chosen: "", selection: [] });
  update({ file });
  void tried(ask("problems", { file })).then((problems) => {
    if (problems && state().file === file) update({ problems });
  });
  if (!(await loadViews(file))) return;
  const { views } = state();
  const found = views.find((each) => each.name === view) ?? views[0];
  await openView(found?.name ?? "");
}

async function loadViews(file: string): Promise<boolean> {
  const answer = await tried(ask("views", { file }));
  if (!answer || state().file !== file) return false;
  update({ views: answer.views });
  return true;
}

/** Shows a view of the file. */
export async function openView(view: string): Promise<void> {
  update({ view, graph: null, graphFault: "", selection: [], bright: null, legal: null });
  await load();
}

let loading: Promise<void> | null = null;
let isOutdated = false;

/** Loads the views and the graph anew; calls while one is under way are answered by one more. */
export async function refresh(): Promise<void> {
  if (loading) {
    isOutdated = true;
    return loading;
  }
  loading = (async () => {
    do {
      isOutdated = false;
      if (await loadViews(state().file)) await load();
    } while (isOutdated);
  })();
  try {
    await loading;
  } finally {
    loading = null;
  }
}

async function load(): Promise<void> {
  const { file, view } = state();
  if (!file || !view) return;
  try {
    const { graph, revision, freshness } = await ask("view", { file, view });
    if (state().file === file && state().view === view) show(graph, revision, freshness);
  } catch (error) {
    if (state().file !== file || state().view !== view) return;
    if (error instanceof CallError && error.code === LOST) return;
    const graphFault = messageOf(error);
    // A fault of the server is none of the picture that is shown: that stays, and is told to be old.
    const isFault = error instanceof CallError && error.code === INTERNAL_ERROR;
    update(isFault ? { graphFault } : { graph: null, graphFault });
  }
}

/** Shows a graph; what was selected in the one before is found again. */
export function show(graph: Graph, revision: number, freshness: Freshness | null = null): void {
  const before = state();
  const selection = before.graph ? carriedOver(before.selection, before.graph, graph) : [];
  const last = selection.at(-1);
  const wasPart = before.graph && before.selection.length > 0;
  update({
    graph,
    revision,
    freshness,
    graphFault: "",
    selection,
    bright: matching(graph, before.filter),
    chosen: last ? elementOf(graph, last) : wasPart ? "" : before.chosen,
  });
}
