import { change } from "../actions";
import { useTrying } from "../answers";
import { Fault } from "../panels/base/parts";
import { useAnswer } from "../panels/base/useAnswer";
import type { FormChildren } from "../protocol";
import { indexOf, partOf } from "../selection";
import { active, type Studio, useRevision, useStudio } from "../store";

/** What a service, a machine or a state of it may own, each to be added by one click. */
export function AddHere({ isMachine }: { isMachine: boolean }) {
  const owner = useStudio(ownerOf);
  const revision = useRevision();
  const { value: form } = useAnswer("form", owner ? { element: owner } : null, revision);
  const [fault, attempt] = useTrying();

  async function add({ feature, label, kinds: [kind] }: FormChildren) {
    if (!kind) return;
    const command = { kind: "add" as const, owner, feature, type: kind.kind };
    await attempt(() => change([{ ...command, values: kind.values ?? {} }], `Add to ${label}`));
  }

  const lists = form?.children.filter((child) => child.many && child.kinds.length > 0) ?? [];
  return (
    <>
      {form && <span>Add to {form.title}:</span>}
      {lists.map((list) => (
        <button
          type="button"
          key={list.feature}
          title={list.documentation}
          onClick={() => add(list)}
        >
          {list.label}
        </button>
      ))}
      <span className="quiet">
        {isMachine
          ? "Draw from state to state for a transition, or press c."
          : "Draw from a query to where its report shall be; press c on a service for what it inherits."}
      </span>
      <Fault>{fault}</Fault>
    </>
  );
}

/** The element of the box that is chosen, else that of the view. */
function ownerOf(studio: Studio): string {
  const { graph } = studio;
  if (!graph) return "";
  const key = active(studio);
  const part = key ? partOf(key) : null;
  const chosen =
    part?.of === "node"
      ? indexOf(graph).nodes.get(part.id)?.element
      : part?.of === "group"
        ? graph.groups.find((group) => group.id === part.id)?.element
        : "";
  return chosen || graph.element;
}
