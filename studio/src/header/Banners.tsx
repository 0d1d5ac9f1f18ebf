import { choose, discard, doAgain, dropDraft } from "../actions";
import type { KeptEdit } from "../protocol";
import { type Outside as Change, type Draft, update, useStudio } from "../store";

/** What stands above all else: a lost connection, a file that is not what it was. */
export function Banners() {
  const link = useStudio((studio) => studio.link);
  const refusal = useStudio((studio) => studio.refusal);
  const outside = useStudio((studio) => studio.outside);
  const kept = useStudio((studio) => studio.kept);
  const drafts = useStudio((studio) => studio.drafts);
  const recorded = useStudio((studio) => studio.recorded);
  const others = outside.filter((change) => !change.isConflict);
  return (
    <div className="banners">
      {link === "lost" && (
        <p className="banner bar error" role="alert">
          × The connection to the server is lost. What you see may be old; trying again.
        </p>
      )}
      {link === "refused" && (
        <p className="banner bar error" role="alert">
          × {refusal}
        </p>
      )}
      {recorded && (
        <p className="banner bar warning" role="status">
          ! The diagram shows a moment of {recorded}, and not what runs now.
        </p>
      )}
      <Worth />
      {kept.map((edit) => (
        <Kept key={edit.number} edit={edit} />
      ))}
      {drafts.map((draft) => (
        <Typed key={`${draft.element} ${draft.field}`} draft={draft} />
      ))}
      {outside
        .filter((change) => change.isConflict)
        .map((change) => (
          <Outside key={change.file} changes={[change]} />
        ))}
      {others.length > 0 && <Outside changes={others} />}
    </div>
  );
}

/** What the diagram is worth, unless it shows the files as they are. */
function Worth() {
  const file = useStudio((studio) =>
    studio.project?.files.find((candidate) => candidate.path === studio.file),
  );
  const graphFault = useStudio((studio) => (studio.graph ? studio.graphFault : ""));
  const freshness = useStudio((studio) => studio.freshness);
  const isOld = freshness !== null && freshness.state !== "current";
  if (graphFault)
    return <p className="banner bar error">× {graphFault}. The diagram is that of before.</p>;
  if (!isOld && !file?.stale) return null;
  const why = isOld ? freshness.why : `${file?.path} cannot be read as it is now`;
  const since = isOld ? freshness.since : null;
  const shows = isOld && since === null ? "nothing for certain" : "how it was before";
  return (
    <p className="banner bar warning" role="status">
      ! {why}. The diagram shows {freshness?.state === "conflict" ? "what the file says" : shows}
      {since !== null && freshness?.state !== "conflict" ? ` (revision ${since})` : ""}; nothing is
      generated from it.
    </p>
  );
}

/** An edit that was not done, with what it would have set. */
function Kept({ edit }: { edit: KeptEdit }) {
  const values = edit.commands.flatMap((command) =>
    command.kind === "set"
      ? [`${inWords(command.feature)}: ${command.values.join(", ") || "nothing"}`]
      : [],
  );
  return (
    <p className="banner bar error" role="status">
      × Not done, and kept: “{edit.label}”{values.length > 0 && ` (${values.join("; ")})`}.{" "}
      {edit.why}.
      <button type="button" onClick={() => void doAgain(edit)}>
        Do it all the same
      </button>
      <button type="button" onClick={() => void discard(edit)}>
        Discard
      </button>
    </p>
  );
}

/** A name of the metamodels as forms have it: `silenceTimeout` becomes `silence timeout`. */
const inWords = (name: string): string =>
  name.replace(/[a-z](?=[A-Z])/g, "$& ").replace(/[A-Z](?=[a-z])/g, (first) => first.toLowerCase());

/** What was typed into a field that is not shown, and could not be taken. */
function Typed({ draft: { element, field, what, text, why } }: { draft: Draft }) {
  return (
    <p className="banner bar error" role="status">
      × {text ? "Typed, and not taken" : "Not taken"}: {what}
      {text && `: “${text.length > MOST_TOLD ? `${text.slice(0, MOST_TOLD)}…` : text}”`}.{" "}
      {why && `${why}.`}
      {element && (
        <button type="button" onClick={() => choose(element)}>
          Go there
        </button>
      )}
      <button type="button" onClick={() => dropDraft(element, field)}>
        Discard
      </button>
    </p>
  );
}

/** What other programs did: one note for each conflict, and one for all else. */
function Outside({ changes }: { changes: Change[] }) {
  const isConflict = changes[0]?.isConflict;
  const files = changes.map((change) => change.file);
  const diff = changes.map((change) => change.diff).join("");
  const named =
    files.length > MOST_NAMED
      ? `${files.slice(0, MOST_NAMED).join(", ")} and ${files.length - MOST_NAMED} more`
      : files.join(", ");
  const dismiss = () =>
    update({ outside: useStudio.getState().outside.filter((change) => !changes.includes(change)) });
  return (
    <p className={`banner bar ${isConflict ? "error" : "info"}`} role="status">
      {isConflict
        ? `× Another program changed ${named} while you did. Its change stands in the file; yours is in the history.`
        : changes.every((change) => change.gone)
          ? `i Another program deleted ${named}; undo brings it back.`
          : `i Another program changed ${named}.`}
      {diff && (
        <button
          type="button"
          onClick={() =>
            update({ dialog: { kind: "diff", title: `What changed in ${named}`, diff } })
          }
        >
          Show the difference
        </button>
      )}
      <button type="button" onClick={dismiss}>
        Dismiss
      </button>
    </p>
  );
}

const MOST_NAMED = 3;
/** Characters of what was typed. */
const MOST_TOLD = 200;
