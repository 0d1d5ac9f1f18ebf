import { beginModel, openView } from "../actions";
import { useStudio } from "../store";

/** What to do with a diagram that has no boxes. */
export function EmptyHint() {
  const isSystem = useStudio((studio) => studio.view === "system");
  return (
    <div className="empty">
      <p>
        <strong>This diagram is empty.</strong>
      </p>
      <p hidden={isSystem}>Add to it by the buttons above.</p>
      <p hidden={!isSystem}>
        Drag a component, a bridge or a node from the palette on the left to here, or search there
        by name and press Enter. <kbd>?</kbd> shows all keys.
      </p>
    </div>
  );
}

/** Why nothing is drawn, and what to do about it. */
export function Nothing() {
  const { link, project, file, views, view } = useStudio();
  if (link === "opening" || (link === "open" && !project)) return <p className="quiet">Opening…</p>;
  if (link === "lost" || link === "refused") return <p className="quiet">There is no server.</p>;
  if (!project?.files.length) {
    return (
      <div className="empty">
        <p>
          <strong>There is no model in {project?.name} yet.</strong>
        </p>
        <button type="button" className="best" onClick={() => void beginModel()}>
          New model…
        </button>
      </div>
    );
  }
  if (view) return <p className="quiet">Drawing {view}…</p>;
  const library = views.find((candidate) => candidate.library);
  return (
    <div className="empty">
      <p>
        <strong>{file || "This file"} has nothing of its own to draw.</strong>
      </p>
      <p>
        Systems, attribute maps, services and state machines are drawn. What is wrong with the file
        stands below, under Problems.
      </p>
      {library && (
        <button type="button" onClick={() => void openView(library.name)}>
          Look at {library.title || library.name} of the library
        </button>
      )}
    </div>
  );
}
