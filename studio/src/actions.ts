// What can be done: each asks the server and brings its answer into the store.

import { following, matching, type Stream } from "./canvas/following";
import { keyOfEnd } from "./canvas/navigation";
import { CallError, type Caller, type Link, type Listener, LOST } from "./connection";
import type {
  Command,
  ConnectOption,
  EditResult,
  GraphEnd,
  LayoutKey,
  Method,
  Notification,
  Notifications,
  PaletteItem,
  Params,
  Point,
  Project,
  Ref,
  Result,
} from "./protocol";
import { carriedOver, elementOf, has, indexOf, nameOf, type PartKey, partOf } from "./selection";
import { active, type Outside, say, state, update } from "./store";

let caller: Caller | null = null;

/** Gives the actions the connection that they use. */
export function use(connection: Caller): void {
  caller = connection;
}

/** Asks the server; use it for what changes nothing. */
export function ask<M extends Method>(method: M, params: Params<M>): Promise<Result<M>> {
  if (!caller) return Promise.reject(new CallError(LOST, "There is no connection to the server."));
  return caller.call(method, params);
}

export function messageOf(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}

/** Awaits, and tells the user what went wrong; undefined then. */
async function tried<T>(work: Promise<T>): Promise<T | undefined> {
  try {
    return await work;
  } catch (error) {
    say(messageOf(error), true);
    return undefined;
  }
}

// The link -----------------------------------------------------------------------------------

export const listener: Listener = {
  onLink(link: Link, project: Project | null, reason: string) {
    update({ link, refusal: reason });
    if (project) void begin(project);
  },
  onNotification<N extends Notification>(name: N, params: Notifications[N]) {
    TAKING[name]?.(params);
  },
};

const TAKING: { [N in Notification]: (params: Notifications[N]) => void } = {
  changed(params) {
    const { project } = state();
    if (!project) return;
    const { files } = params;
    update({ project: { ...project, revision: params.revision, files } });
    if (!files.some((each) => each.path === state().file)) {
      void openFile(files[0]?.path ?? "");
      return;
    }
    if (params.by === "outside") say("A file was changed by another program.");
    void refresh();
  },
  problems(params) {
    const before = state().problems;
    update({ problems: params });
    const words = verdict(params.problems);
    if (!before || verdict(before.problems) !== words) say(words);
  },
  conflict(params) {
    noteOutside({ ...params, isConflict: true });
    say(`${params.file} was changed by another program, and here.`, true);
  },
  outside(params) {
    noteOutside({ ...params, isConflict: false });
  },
  live(params) {
    update({ live: params.state });
  },
};

/** Keeps the last change of each file; a conflict stays until it is dismissed. */
function noteOutside(change: Outside): void {
  const { outside } = state();
  if (!change.isConflict && outside.some((each) => each.file === change.file && each.isConflict)) {
    return;
  }
  update({ outside: [...outside.filter((each) => each.file !== change.file), change] });
}

function verdict(problems: { severity: string }[]): string {
  const count = (severity: string) => problems.filter((each) => each.severity === severity).length;
  const [errors, warnings] = [count("error"), count("warning")];
  if (!errors && !warnings) return "No problems.";
  const words = (n: number, word: string) => (n ? [`${n} ${word}${n === 1 ? "" : "s"}`] : []);
  return `${[...words(errors, "error"), ...words(warnings, "warning")].join(", ")}.`;
}

async function begin(project: Project): Promise<void> {
  update({ project });
  const { file, view } = state();
  const kept = project.files.some((each) => each.path === file) ? file : "";
  const chosen = kept || project.opened || project.files[0]?.path || "";
  if (chosen) await openFile(chosen, kept ? view : "");
}

// Files and views ----------------------------------------------------------------------------

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
    const { graph, revision } = await ask("view", { file, view });
    if (state().file === file && state().view === view) show(graph, revision);
  } catch (error) {
    if (state().file !== file || state().view !== view) return;
    if (error instanceof CallError && error.code === LOST) return;
    update({ graph: null, graphFault: messageOf(error) });
  }
}

function show(graph: Result<"view">["graph"], revision: number): void {
  const before = state();
  const selection = before.graph ? carriedOver(before.selection, before.graph, graph) : [];
  const last = selection.at(-1);
  const wasPart = before.graph && before.selection.length > 0;
  update({
    graph,
    revision,
    graphFault: "",
    selection,
    bright: matching(graph, before.filter),
    chosen: last ? elementOf(graph, last) : wasPart ? "" : before.chosen,
  });
}

// Choosing -----------------------------------------------------------------------------------

/** Selects parts of the graph; the last one is shown in the form. */
export function select(selection: PartKey[]): void {
  const { graph } = state();
  const last = selection.at(-1);
  update({ selection, chosen: graph && last ? elementOf(graph, last) : "" });
}

/** Shows an element in form and source, and selects it where the graph has it. */
export function choose(element: Ref): void {
  const { graph } = state();
  const key = graph ? indexOf(graph).byElement.get(element) : undefined;
  update({ chosen: element, selection: key ? [key] : [] });
}

/** Shows an element in the file where it stands, whichever file is shown now. */
export async function reveal(element: Ref, file: string): Promise<void> {
  if (file && file !== state().file && state().project?.files.some((each) => each.path === file)) {
    await openFile(file);
  }
  choose(element);
}

// Changing -----------------------------------------------------------------------------------

/**
 * Changes the model.
 *
 * @throws CallError The server refused, and why.
 */
export async function change(commands: Command[], label: string): Promise<EditResult> {
  const base = state().project?.revision ?? state().revision;
  return settled(await ask("edit", { commands, label, base }), label);
}

/** Changes the model; null if the server refused, which the user is told. */
export async function edit(commands: Command[], label: string): Promise<EditResult | null> {
  return commands.length ? ((await tried(change(commands, label))) ?? null) : null;
}

async function settled(result: EditResult, label: string): Promise<EditResult> {
  update({ undoable: result.entry ?? state().undoable });
  say(label);
  if (state().revision < result.revision) await refresh();
  const created = result.created[0];
  if (created) choose(created);
  return result;
}

/** Makes a model file with an empty system, and opens it. */
export async function newModel(file: string): Promise<void> {
  const name = file.replace(/^.*\//, "").replace(/\.[^.]*$/, "");
  const create: Command = { kind: "create", file, type: "system.System", values: { name: [name] } };
  if (await edit([create], `Create ${file}`)) await openFile(file);
}

/** Tells what an edit would do, without doing it. */
export function dryRun(commands: Command[], label: string): Promise<EditResult | undefined> {
  return tried(ask("edit", { commands, label, dry: true }));
}

export async function undo(): Promise<void> {
  const result = await tried(ask("undo", {}));
  if (!result) return;
  say(result.entry ? `Undone: ${result.entry.label}` : "There is nothing to undo.");
  if (state().revision < result.revision) await refresh();
}

export async function redo(): Promise<void> {
  const result = await tried(ask("redo", {}));
  if (!result) return;
  say(result.entry ? `Done again: ${result.entry.label}` : "There is nothing to do again.");
  if (state().revision < result.revision) await refresh();
}

/** Removes elements; asks first where others refer to them. */
export async function remove(elements: Ref[], what: string): Promise<void> {
  const commands: Command[] = elements.map((element) => ({ kind: "remove", element }));
  if (!commands.length) return;
  const label = `Remove ${what}`;
  const dry = await dryRun(commands, label);
  if (!dry) return;
  const referrers = dry.referrers ?? [];
  if (!referrers.length) {
    await edit(commands, label);
    return;
  }
  update({ dialog: { kind: "delete", commands, label, referrers, diff: dry.diff ?? "" } });
}

/** Removes what is selected. */
export async function removeSelected(): Promise<void> {
  const { elements, what } = selected();
  if (elements.length) return remove(elements, what);
  const key = active(state());
  const part = key ? partOf(key) : null;
  if (part?.of === "edge") return unlink(part.id);
  say("Nothing is selected that could be removed.");
}

/** Takes a line away that is no element, such as one that shows a reference. */
async function unlink(line: string): Promise<void> {
  const { file, view } = state();
  const answer = await tried(ask("unlink", { file, view, line }));
  const [option] = answer?.options ?? [];
  if (option) await edit(option.commands, option.label);
  else if (answer) say(answer.refusal);
}

function selected(): { elements: Ref[]; what: string } {
  const { graph, selection } = state();
  if (!graph) return { elements: [], what: "" };
  const known = selection.filter((key) => elementOf(graph, key));
  const elements = [...new Set(known.map((key) => elementOf(graph, key)))];
  const name = known[0] ? nameOf(graph, known[0]) : "";
  return { elements, what: elements.length === 1 ? name : `${elements.length} elements` };
}

/** Begins to rename what the keyboard stands on. */
export async function beginRename(key = active(state())): Promise<void> {
  const { graph } = state();
  const element = graph && key ? elementOf(graph, key) : "";
  if (!key || !element) return say("What is selected has no name to change.");
  const form = await tried(ask("form", { element }));
  if (!form) return;
  const field = form.fields.find((each) => each.feature === "name");
  if (!field?.changeable || form.readonly) {
    return say("What is selected has no name that can be changed here.");
  }
  const name = field.values[0] ?? "";
  if (partOf(key).of === "edge" || partOf(key).of === "group") {
    update({ dialog: { kind: "rename", element, name } });
  } else {
    update({ renaming: { key, element, name } });
  }
}

export async function rename(element: Ref, before: string, name: string): Promise<void> {
  update({ renaming: null, dialog: null });
  const { selection } = state();
  if (!name || name === before) return;
  if (!(await edit([{ kind: "rename", element, name }], `Rename ${before} to ${name}`))) return;
  // Names change the keys by which parts are found again, positions do not.
  const { graph } = state();
  if (graph && !state().selection.length) select(selection.filter((key) => has(graph, key)));
}

/** Keeps boxes of the view where the user put them. */
export function place(positions: Record<LayoutKey, Point>): Promise<EditResult | null> {
  const count = Object.keys(positions).length;
  const label = count === 1 ? "Move a box" : `Move ${count} boxes`;
  return edit([{ kind: "place", file: state().file, view: state().view, positions }], label);
}

/** Lets the layout place every box anew. */
export async function arrange(): Promise<void> {
  const { file, view } = state();
  const answer = await tried(ask("arrange", { file, view }));
  if (!answer || state().view !== view) return;
  show(answer.graph, answer.revision);
  say("Arranged.");
}

// Copying ------------------------------------------------------------------------------------

export async function copySelected(): Promise<boolean> {
  const { elements, what } = selected();
  if (!elements.length) {
    say("Nothing is selected that could be copied.");
    return false;
  }
  const answer = await tried(ask("copy", { elements }));
  if (!answer) return false;
  update({ clip: answer.commands });
  say(`Copied ${what}.`);
  return true;
}

export async function cutSelected(): Promise<void> {
  if (await copySelected()) await removeSelected();
}

/** Pastes into what is chosen, or beside it; the server finds the owner that fits. */
export async function paste(): Promise<void> {
  const { clip, chosen, file } = state();
  if (!clip.length) return say("Nothing was copied.");
  const owner = chosen || `${file}#/`;
  const result = await tried(ask("paste", { owner, commands: clip }));
  if (result) await settled(result, "Paste");
}

// Palette and connecting ---------------------------------------------------------------------

/** Adds what an item of the palette holds, where it was dropped if it was dropped. */
export async function drop(item: PaletteItem, at: Point | null = null): Promise<void> {
  const result = await edit(item.drop.commands, item.label_of_edit);
  if (!result || !at) return;
  const { graph } = state();
  const created = new Set(result.created);
  const node = graph?.nodes.find((each) => created.has(each.element));
  if (node) await place({ [node.key]: [Math.round(at[0]), Math.round(at[1])] });
}

/** Offers how two ends may be connected. */
export async function connect(source: GraphEnd, target: GraphEnd): Promise<void> {
  const { file, view } = state();
  const answer = await tried(ask("connect", { file, view, source, target }));
  if (answer) update({ dialog: { kind: "connect", source, target, ...answer } });
}

export async function take(option: ConnectOption): Promise<void> {
  update({ dialog: null });
  await edit(option.commands, option.label);
}

/** Offers the ends that what the keyboard stands on can be connected to. */
export async function offerEnds(key = active(state())): Promise<void> {
  const from = key ? endOf(key) : null;
  if (!from) return say("Choose a box or a row first.");
  const { file, view } = state();
  const answer = await tried(ask("ends", { file, view, ...from }));
  if (answer) update({ dialog: { kind: "ends", from, ends: answer.ends } });
}

export function endOf(key: PartKey): GraphEnd | null {
  const part = partOf(key);
  if (part.of === "node") return { node: part.id, port: "" };
  return part.of === "port" ? { node: part.node, port: part.id } : null;
}

/** Type of what the palette gives to a drag: the item as JSON. */
export const DRAGGED = "application/x-jausml-palette-item";

// Filtering and focusing ---------------------------------------------------------------------

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

let drawings = 0;

/** Shows where a line that begins at an end may end, until `endDrawing`. */
export async function beginDrawing(from: GraphEnd): Promise<void> {
  const { file, view, graph } = state();
  const drawing = ++drawings;
  // Without an answer the line can still be drawn; the server judges it then.
  const answer = await ask("ends", { file, view, ...from }).catch(() => null);
  if (!answer || !graph || drawing !== drawings) return;
  update({ legal: new Set(answer.ends.map((end) => keyOfEnd(graph, end))) });
}

export function endDrawing(): void {
  drawings++;
  update({ legal: null });
}
