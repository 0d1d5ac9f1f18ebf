// Files and their views: which of them is shown.

import { matching } from "../canvas/following";
import { CallError, INTERNAL_ERROR, LOST } from "../connection";
import type {
  Freshness,
  Graph,
  GraphChanges,
  LayoutKey,
  PartChanges,
  Problems,
  ViewResult,
} from "../protocol";
import { carriedOver, elementOf, indexOf } from "../selection";
import { state, update } from "../store";
import { ask, messageOf, tried } from "./asking";

/** Shows a file, at a view of it or at its first. */
export async function openFile(file: string, view = ""): Promise<void> {
  if (!file) {
    const nothing = { graph: null, problems: null, freshness: null, chosen: "", selection: [] };
    return update({ file, views: [], view: "", ...nothing });
  }
  update({ file, views: [] });
  if (await loadViews(file)) {
    const { views } = state();
    const shown = views.find((candidate) => candidate.name === view) ?? views[0];
    await openView(shown?.name ?? "");
  }
  // The picture first: to judge a large system takes longer than to draw it.
  const problems = await tried(ask("problems", { file }));
  if (problems && state().file === file) takeProblems(problems);
}

/** Shows what is wrong, in the graph too, where that was drawn before it was known. */
export function takeProblems(problems: Problems): void {
  update({ problems });
  if (!state().isChecked && problems.revision === state().revision) void draw();
}

async function loadViews(file: string): Promise<boolean> {
  const answer = await tried(ask("views", { file }));
  if (!answer || state().file !== file) return false;
  const { views: before, view } = state();
  const { views } = answer;
  const at = before.findIndex((candidate) => candidate.name === view);
  const isGone = !views.some((other) => other.name === view);
  // What a view shows was renamed, where there are as many as before.
  const renamed = isGone && views.length === before.length ? views[at] : undefined;
  update({ views, ...(renamed && { view: renamed.name, picture: 0 }) });
  return true;
}

/** Shows a view of the file. */
export async function openView(view: string): Promise<void> {
  const empty = { graph: null, picture: 0, opened: [], selection: [], bright: null, legal: null };
  const sight = view === state().view ? state().sight : null;
  update({ view, sight, graphFault: "", visits: state().visits + 1, ...empty });
  await load();
}

let loading: Promise<void> | null = null;
let isOutdated = false;

/** Loads the views and the graph anew; calls while one is under way are answered by one more. */
export function refresh(): Promise<void> {
  return again(async () => {
    if (await loadViews(state().file)) await load();
  });
}

/** Loads the graph anew. */
export function draw(): Promise<void> {
  return again(load);
}

async function again(work: () => Promise<void>): Promise<void> {
  if (loading) {
    isOutdated = true;
    return loading;
  }
  loading = (async () => {
    await work();
    while (isOutdated) {
      isOutdated = false;
      if (await loadViews(state().file)) await load();
    }
  })();
  try {
    await loading;
  } finally {
    loading = null;
  }
}

async function load(): Promise<void> {
  const { file, view, opened, picture: base } = state();
  if (!file || !view) return;
  try {
    const answer = await ask("view", { file, view, opened, base });
    if (state().file === file && state().view === view) takePicture(answer);
  } catch (error) {
    if (state().file !== file || state().view !== view) return;
    if (error instanceof CallError && error.code === LOST) return;
    const graphFault = messageOf(error);
    // A fault of the server is none of the picture that is shown: that stays, and is told to be old.
    const isFault = error instanceof CallError && error.code === INTERNAL_ERROR;
    update(isFault ? { graphFault } : { graph: null, graphFault });
  }
}

/** Shows a picture, or what has changed in the one that is shown. */
export function takePicture(answer: ViewResult): void {
  const { graph: shown, picture: base } = state();
  const { changes, picture = 0, checked = true, revision, freshness } = answer;
  const graph = changes && shown && changes.base === base ? changed(shown, changes) : answer.graph;
  update({ picture: graph ? picture : 0, isChecked: checked });
  if (graph) show(graph, revision, freshness);
  else isOutdated = true; // it differs from a picture that is not shown: all of it is asked for
}

/** Shows the whole view. */
export function fitAll(): void {
  update({ fits: state().fits + 1 });
}

/** Shows what is in these frames, and in these alone. */
export function openFrames(opened: LayoutKey[]): void {
  update({ opened });
  void draw();
}

/** Shows a graph; what was selected in the one before is found again. */
export function show(graph: Graph, revision: number, freshness: Freshness | null = null): void {
  const before = state();
  const { renames } = before;
  let selection = before.graph
    ? carriedOver(before.selection, before.graph, graph, renames > 0)
    : [];
  // What was chosen is selected where it comes into a picture, and stays when that is left.
  const chosen = indexOf(graph).byElement.get(before.chosen);
  if (!selection.length && (graph.folded || renames || !before.graph) && chosen)
    selection = [chosen];
  const last = selection.at(-1);
  const wasPart =
    before.graph && before.selection.length > 0 && !(graph.folded && revision === before.revision);
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

// Parts that have not changed stay the same objects, and are not drawn anew.

/** The picture that differs so from one. */
export function changed(graph: Graph, { nodes, groups, edges, rest }: GraphChanges): Graph {
  return {
    ...rest,
    nodes: changedParts(graph.nodes, nodes),
    groups: changedParts(graph.groups, groups),
    edges: changedParts(graph.edges, edges),
  };
}

function changedParts<T extends { id: string }>(parts: T[], changes: PartChanges<T>): T[] {
  if (!changes.put.length && !changes.gone.length && !changes.order) return parts;
  const known = new Map(parts.map((part) => [part.id, part]));
  for (const id of changes.gone) known.delete(id);
  for (const part of changes.put) known.set(part.id, part);
  return changes.order?.flatMap((id) => known.get(id) ?? []) ?? [...known.values()];
}
