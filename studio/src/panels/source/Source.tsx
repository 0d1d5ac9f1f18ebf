import { lazy, Suspense, useMemo } from "react";
import { ask, choose } from "../../actions";
import { revisionOf, useRevision, useStudio } from "../../store";
import { Fault, Quiet } from "../base/parts";
import { useAnswer } from "../base/useAnswer";

// CodeMirror is the larger half of the page: it comes when it is looked at.
const TextEditor = lazy(() =>
  import("./TextEditor").then((module) => ({ default: module.TextEditor })),
);

/** The text of what is chosen, in its file: ros2jaus to be edited, XMI to be read. */
export function Source() {
  const project = useStudio((studio) => studio.project);
  const opened = useStudio((studio) => studio.file);
  const element = useStudio((studio) => studio.chosen);
  const revision = useRevision();
  const { value: source, error } = useAnswer(
    "source",
    element ? { element } : null,
    useStudio(revisionOf),
  );

  const file = source?.file ?? opened;
  const info = project?.files.find((candidate) => candidate.path === file);
  const notation = source?.notation ?? info?.notation ?? "xmi";
  const { start, end } = source ?? { start: 0, end: 0 };
  const hasSpan = source !== null;
  const span = useMemo(() => (hasSpan ? { start, end } : null), [hasSpan, start, end]);

  async function onCursor(offset: number) {
    const { element: pointed } = await ask("at", { file, offset }).catch(() => ({ element: "" }));
    if (pointed !== "" && pointed !== element) choose(pointed);
  }

  if (!project || !file) return <Quiet>No file is open.</Quiet>;
  return (
    <section className="source" aria-label="Source">
      <header className="bar">
        <strong>{file}</strong>
        {info?.stale && (
          <span className="badge">
            what is shown elsewhere is the last state that could be read
          </span>
        )}
        {notation === "xmi" && (
          <span className="quiet">read-only; change it in the diagram or the properties</span>
        )}
      </header>
      {error && <Fault>{error}</Fault>}
      <Suspense fallback={<Quiet>Opening the editor…</Quiet>}>
        <TextEditor
          key={file}
          root={project.root}
          file={file}
          notation={notation}
          revision={revision}
          span={span}
          onCursor={onCursor}
        />
      </Suspense>
    </section>
  );
}
