import { useEffect, useRef, useState } from "react";
import { ask, change, choose, messageOf, remove } from "../../actions";
import type { ChildKind, Command, FormChildren, FormField, Ref } from "../../protocol";
import { revisionOf, useStudio } from "../../store";
import { Fault, FIELDS, Help, Quiet } from "../base/parts";
import { useAnswer } from "../base/useAnswer";
import { ChildrenRow } from "./ChildrenRow";
import { FieldRow } from "./FieldRow";

/** The properties of the chosen element: what the metamodel knows about it, to be read and changed. */
export function PropertyForm() {
  const element = useStudio((studio) => studio.chosen);
  const choice = useStudio((studio) => studio.choice);
  const revision = useStudio(revisionOf);
  const {
    value: form,
    error,
    isPending,
  } = useAnswer("form", element ? { element } : null, revision, `${choice}`);
  const [fault, setFault] = useState("");
  const shown = useRef<HTMLFormElement>(null);
  const adding = useRef(Promise.resolve());
  const isRead = form !== null;
  useEffect(() => {
    const panel = isRead && shown.current?.closest("[role='tabpanel']");
    if (panel && panel === document.activeElement) {
      panel.querySelector<HTMLElement>(FIELDS)?.focus(); // whoever asked for the form waits there
    }
  }, [isRead]);

  if (!element) return <Quiet>Choose something in the diagram to see its properties.</Quiet>;
  if (form === null && error) return <Fault>{error}</Fault>;
  if (form === null) return <Quiet>{isPending ? "Reading…" : "There are no properties."}</Quiet>;

  /** Makes one edit; resolves to why it was refused, or nothing. */
  async function make(command: Command, label: string): Promise<string> {
    try {
      await change([command], label);
      return "";
    } catch (error) {
      return messageOf(error);
    }
  }

  function set(field: FormField, values: string[], element: Ref, title: string): Promise<string> {
    const name = values[0];
    if (field.feature === "name" && name !== undefined)
      return make({ kind: "rename", element, name }, `Rename ${title} to ${name}`);
    const label = `${values.length > 0 ? "Set" : "Unset"} ${field.label} of ${title}`;
    return make({ kind: "set", element, feature: field.feature, values }, label);
  }

  /** Adds a child, and goes to it unless its name was typed: then the next one may be. */
  function add({ feature }: FormChildren, { kind, label }: ChildKind, name: string) {
    adding.current = adding.current.then(async () => {
      try {
        // What a new one begins with depends on the one before.
        const { children } = await ask("form", { element });
        const kinds = children.find((child) => child.feature === feature)?.kinds;
        const usual = kinds?.find((candidate) => candidate.kind === kind)?.values ?? {};
        // Some begin with what they are called by too, such as a topic.
        const named = Object.entries(usual).map(([attribute, texts]) => [
          attribute,
          name && texts[0] === usual.name?.[0] ? [name] : texts,
        ]);
        const values = Object.fromEntries(named) as Record<string, string[]>;
        const command: Command = { kind: "add", owner: element, feature, type: kind, values };
        await change([command], `Add ${name || label}`, undefined, undefined, !name);
        setFault("");
      } catch (error) {
        setFault(messageOf(error));
      }
    });
  }

  async function move(moved: Ref, feature: string, position: number) {
    setFault(
      await make({ kind: "move", element: moved, owner: element, feature, position }, "Reorder"),
    );
  }

  return (
    <form
      ref={shown}
      className="property-form"
      aria-label={`Properties of ${form.title}`}
      onSubmit={(event) => event.preventDefault()}
    >
      <header className="bar">
        <h2>{form.title}</h2>
        <small className="quiet">{form.class}</small>
        <Help subject={form.class}>{form.documentation}</Help>
        {form.owner !== "" && (
          <button
            type="button"
            className="small"
            title="Go to what holds it"
            aria-label="Go to what holds it"
            onClick={() => choose(form.owner)}
          >
            ↑
          </button>
        )}
      </header>
      {form.readonly && <Quiet>This belongs to the library and is not changed here.</Quiet>}
      <Fault>{fault || error}</Fault>
      {inGroups(form.fields).map(([group, fields]) => (
        <fieldset key={`${group} ${fields[0]?.feature}`}>
          {group && <legend>{group}</legend>}
          {fields.map((field) => (
            <FieldRow
              key={`${choice} ${field.feature}`}
              element={element}
              of={form.title}
              field={form.readonly ? { ...field, changeable: false } : field}
              onSet={(values) => set(field, values, element, form.title)}
              onJump={(target) => choose(target)}
            />
          ))}
        </fieldset>
      ))}
      {form.children.map((entry) => (
        <ChildrenRow
          key={`${element} ${entry.feature}`}
          held={entry}
          readonly={form.readonly}
          onAdd={(kind, name) => add(entry, kind, name)}
          onSet={(child, field, values) => set(field, values, child.element, child.label)}
          onRemove={(target, label) => remove([target], label)}
          onMove={(target, position) => move(target, entry.feature, position)}
          onJump={(target) => choose(target)}
        />
      ))}
    </form>
  );
}

/** Fields that follow each other and are about the same, with what that is. */
function inGroups(fields: FormField[]): [group: string, fields: FormField[]][] {
  const groups: [string, FormField[]][] = [];
  for (const field of fields) {
    const last = groups.at(-1);
    if (last?.[0] === field.group) last[1].push(field);
    else groups.push([field.group, [field]]);
  }
  return groups;
}
