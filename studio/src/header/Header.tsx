import { beginModel, bridgesOf, openFile, openView, redo, undo } from "../actions";
import type { ViewInfo } from "../protocol";
import { update, useStudio } from "../store";

/** What is open: the file, its view, and what can be done with the whole. */
export function Header() {
  const project = useStudio((studio) => studio.project);
  const file = useStudio((studio) => studio.file);
  const views = useStudio((studio) => studio.views);
  const view = useStudio((studio) => studio.view);
  const hasBridges = useStudio(({ graph }) => graph !== null && bridgesOf(graph).length > 0);
  return (
    <header className="header bar">
      <h1>
        jausml studio <small>{project?.name}</small>
      </h1>
      <label>
        File
        <select value={file} onChange={(event) => void openFile(event.currentTarget.value)}>
          {project?.files.map((entry) => (
            <option key={entry.path} value={entry.path}>
              {entry.path}
              {entry.dirty ? " (cannot be parsed)" : entry.stale ? " (stale)" : ""}
            </option>
          ))}
        </select>
      </label>
      <label>
        View
        <select
          value={view.replace(/^bodies:/, "service:")}
          onChange={(event) => void openView(event.currentTarget.value)}
        >
          {views
            .filter((other) => !other.library)
            .map((entry) => (
              <option key={entry.name} value={entry.name}>
                {titleOf(entry)}
              </option>
            ))}
          {libraryGroups(views).map(([kind, group]) => (
            <optgroup key={kind} label={`Library: ${KINDS[kind].toLowerCase()}s`}>
              {group.map((entry) => (
                <option key={entry.name} value={entry.name}>
                  {entry.title}
                </option>
              ))}
            </optgroup>
          ))}
        </select>
      </label>
      <span className="spring" />
      <button type="button" onClick={() => update({ dialog: { kind: "operate" } })}>
        Operate…
      </button>
      {hasBridges && (
        <button
          type="button"
          onClick={() => update({ dialog: { kind: "partition" } })}
          title="Propose which bridge carries which connections"
        >
          Bridges…
        </button>
      )}
      <button type="button" disabled={!project} onClick={() => void beginModel()}>
        New model…
      </button>
      {/* A button that is disabled while it has the focus would lose it. */}
      <button
        type="button"
        aria-disabled={!project?.undoable}
        onClick={() => void undo()}
        title="Ctrl+Z"
      >
        Undo
      </button>
      <button
        type="button"
        aria-disabled={!project?.redoable}
        onClick={() => void redo()}
        title="Ctrl+Shift+Z"
      >
        Redo
      </button>
      <button type="button" onClick={() => update({ dialog: { kind: "help" } })} title="?">
        Keys
      </button>
    </header>
  );
}

const KINDS = { system: "System", map: "Map", service: "Service", machine: "State machine" };

/** Views of the library by their kinds, in the order of their names. */
function libraryGroups(views: ViewInfo[]): [ViewInfo["kind"], ViewInfo[]][] {
  const library = views.filter((view) => view.library);
  const kinds = [...new Set(library.map((view) => view.kind))];
  return kinds.map((kind) => [
    kind,
    library
      .filter((view) => view.kind === kind)
      .sort((one, other) => one.title.localeCompare(other.title)),
  ]);
}

function titleOf({ kind, title }: ViewInfo): string {
  return title && title !== kind ? `${KINDS[kind]}: ${title}` : KINDS[kind];
}
