// What the server tells without being asked.

import type { Link, Listener } from "../connection";
import type { KeptEdit, Notification, Notifications, Project } from "../protocol";
import { type Outside, say, state, update } from "../store";
import { verdict } from "../verdicts";
import { ask } from "./asking";
import { keepDraft } from "./drafting";
import { openFile, refresh, takeProblems } from "./showing";

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
    const { revision, files, undoable, redoable } = params;
    update({ project: { ...project, revision, files, undoable, redoable } });
    if (!files.some((file) => file.path === state().file)) {
      void openFile(files[0]?.path ?? "");
      return;
    }
    if (params.by === "outside") say("A file was changed by another program.");
    void refresh();
  },
  problems(params) {
    const before = state().problems;
    takeProblems(params);
    const words = verdict(params.problems, params.fault);
    if (!before || verdict(before.problems, before.fault) !== words) say(words);
  },
  conflict(params) {
    noteOutside({ ...params, isConflict: true });
    say(`${params.file} was changed by another program, and here.`, true);
  },
  outside(params) {
    noteOutside({ ...params, isConflict: false });
  },
  live(params) {
    if (!state().recorded) update({ live: params.state, liveAt: performance.now() });
  },
  kept({ edits }) {
    update({ kept: edits });
  },
};

/** Keeps the last change of each file; a conflict stays until it is dismissed. */
function noteOutside(change: Outside): void {
  const { outside } = state();
  if (
    !change.isConflict &&
    outside.some((other) => other.file === change.file && other.isConflict)
  ) {
    return;
  }
  update({ outside: [...outside.filter((other) => other.file !== change.file), change] });
}

/** Keeps the words of edits that a server before this one kept: they ended with it. */
function noteLost(edits: KeptEdit[]): void {
  for (const { number, label, commands } of state().kept) {
    if (edits.some((edit) => edit.number === number && edit.label === label)) continue;
    const values = commands.flatMap((command) => (command.kind === "set" ? command.values : []));
    const named = commands.find((command) => "element" in command);
    keepDraft({
      element: named && "element" in named ? named.element : "",
      field: `kept ${number}`,
      what: label,
      text: values.join(", "),
      why: "The server that kept it has ended",
    });
  }
}

async function begin(project: Project): Promise<void> {
  update({ project });
  if (project.recordings?.length) update({ bottom: "recording" });
  // Without an answer the next one that is kept tells of all.
  ask("kept", {}).then(
    ({ edits }) => {
      noteLost(edits);
      update({ kept: edits });
    },
    () => undefined,
  );
  const { file, view } = state();
  const kept = project.files.some((other) => other.path === file) ? file : "";
  const chosen = kept || project.opened || project.files[0]?.path || "";
  if (chosen) await openFile(chosen, kept ? view : "");
}
