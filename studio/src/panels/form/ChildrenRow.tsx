import { useId, useState } from "react";
import type { ChildKind, FormChild, FormChildren, FormField, Ref } from "../../protocol";
import { Help, Messages, Order, Select } from "../base/parts";
import { ValueInput } from "./ValueInput";

interface Props {
  held: FormChildren;
  readonly: boolean;
  /** Adds one; the name is empty where none was typed. */
  onAdd: (kind: ChildKind, name: string) => void;
  /** Sets a cell of a child; resolves to why it was refused, or nothing. */
  onSet: (child: FormChild, field: FormField, values: string[]) => Promise<string>;
  onRemove: (element: Ref, label: string) => void;
  onMove: (element: Ref, position: number) => void;
  onJump: (element: Ref) => void;
}

/** What an element holds under one feature: go to it, change it, add, move and remove. */
export function ChildrenRow({ held, readonly, onAdd, onSet, onRemove, onMove, onJump }: Props) {
  const [fault, setFault] = useState("");
  const [name, setName] = useState("");
  const [kind, setKind] = useState("");
  const id = useId();
  const chosen = held.kinds.find((candidate) => candidate.kind === kind) ?? held.kinds[0];
  const mayAdd = !readonly && chosen !== undefined && (held.many || held.elements.length === 0);
  if (held.elements.length === 0 && !mayAdd) return null;
  return (
    <div className="field children" data-feature={held.feature}>
      <div className="field-label">
        <span>{held.label}</span>
        <Help subject={held.label}>{held.documentation}</Help>
      </div>
      <ul className="values" aria-label={held.label}>
        {held.elements.map((element, index) => (
          <li key={element.element}>
            <button type="button" className="link" onClick={() => onJump(element.element)}>
              {element.label} <small>{element.kind}</small>
            </button>
            {!readonly && (
              <Order
                name={element.label}
                at={index}
                count={held.elements.length}
                onMove={held.many ? (to) => onMove(element.element, to) : undefined}
                onRemove={() => onRemove(element.element, element.label)}
              />
            )}
            {element.cells && element.cells.length > 0 && (
              <span className="cells">
                {element.cells.map((field) => (
                  <ValueInput
                    key={field.feature}
                    element={element.element}
                    of={element.label}
                    field={{ ...field, default: field.default || field.label }}
                    index={0}
                    label={`${field.label} of ${element.label}`}
                    describedBy={`${id}-fault`}
                    isWrong={false}
                    onFault={setFault}
                    onChange={async (value) => {
                      const why = await onSet(element, field, value === "" ? [] : [value]);
                      setFault(why);
                      return why;
                    }}
                  />
                ))}
              </span>
            )}
          </li>
        ))}
      </ul>
      <Messages id={`${id}-fault`} messages={fault ? [fault] : []} />
      {mayAdd && (
        <div className="field-value">
          {held.kinds.length > 1 && (
            <Select
              label={`Kind to add to ${held.label}`}
              title={chosen.documentation}
              value={chosen.kind}
              options={held.kinds.map((entry) => [entry.kind, entry.label])}
              onChoose={setKind}
            />
          )}
          {held.many && chosen.values?.name && (
            <input
              type="text"
              aria-label={`Name to add to ${held.label}`}
              title="Enter adds it, and the next one may be typed"
              placeholder="name, Enter"
              autoComplete="off"
              spellCheck="false"
              value={name}
              onChange={(event) => setName(event.currentTarget.value)}
              onKeyDown={(event) => {
                if (event.key !== "Enter" || !name.trim()) return;
                event.preventDefault();
                onAdd(chosen, name.trim());
                setName("");
              }}
            />
          )}
          <button type="button" title={chosen.documentation} onClick={() => onAdd(chosen, "")}>
            Add {chosen.label}
          </button>
        </div>
      )}
    </div>
  );
}
