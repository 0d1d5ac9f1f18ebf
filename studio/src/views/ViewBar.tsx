import { useStudio } from "../store";
import { AddHere } from "./AddHere";
import { FillOffer } from "./FillOffer";

/** What can be done with a view of a map, a service or a machine as a whole; nothing for a system. */
export function ViewBar() {
  const view = useStudio((studio) => studio.view);
  const isLibrary = useStudio(
    (studio) => studio.views.find((candidate) => candidate.name === studio.view)?.library ?? false,
  );
  const kind = view.split(":")[0];
  if (kind !== "map" && kind !== "service" && kind !== "machine") return null;
  return (
    <div className="view-bar bar">
      {isLibrary ? (
        <p className="quiet">This belongs to the shipped library: it is read-only.</p>
      ) : kind === "map" ? (
        <FillOffer key={view} />
      ) : (
        <AddHere isMachine={kind === "machine"} />
      )}
    </div>
  );
}
