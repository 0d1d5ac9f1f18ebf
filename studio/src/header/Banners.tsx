import { update, useStudio } from "../store";

/** What stands above all else: a lost connection, a file that is not what it was. */
export function Banners() {
  const link = useStudio((studio) => studio.link);
  const refusal = useStudio((studio) => studio.refusal);
  const outside = useStudio((studio) => studio.outside);
  const file = useStudio((studio) =>
    studio.project?.files.find((each) => each.path === studio.file),
  );
  return (
    <div className="banners">
      {link === "lost" && (
        <p className="banner error" role="alert">
          × The connection to the server is lost. What you see may be old; trying again.
        </p>
      )}
      {link === "refused" && (
        <p className="banner error" role="alert">
          × {refusal}
        </p>
      )}
      {file?.stale && (
        <p className="banner warning" role="status">
          ! {file.path} cannot be read as it is now. The diagram shows how it was when it could.
        </p>
      )}
      {outside.map((each) => (
        <Outside key={each.file} file={each.file} diff={each.diff} isConflict={each.isConflict} />
      ))}
    </div>
  );
}

function Outside({ file, diff, isConflict }: { file: string; diff: string; isConflict: boolean }) {
  const dismiss = () =>
    update({ outside: useStudio.getState().outside.filter((each) => each.file !== file) });
  return (
    <p className={`banner ${isConflict ? "error" : "info"}`} role="status">
      {isConflict
        ? `× Another program changed ${file} while you did. Its change stands in the file; yours is in the history.`
        : `i Another program changed ${file}.`}
      {diff && (
        <button
          type="button"
          onClick={() =>
            update({ dialog: { kind: "diff", title: `What changed in ${file}`, diff } })
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
