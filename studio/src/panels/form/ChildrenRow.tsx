import { useId, useState } from "react";
import type { ChildKind, FormChild, FormChildren, FormField, Ref } from "../../protocol";
import { Help, Messages } from "../base/parts";
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
  const chosen = held.kinds.find((each) => each.kind === kind) ?? held.kinds[0];
  const mayAdd = !readonly && chosen !== undefined && (held.many || held.elements.length === 0);
  const mayMove = !readonly && held.many && held.elements.length > 1;
  if (held.elements.length === 0 && !mayAdd) return null;
  return (
    <div className="field children" data-feature={held.feature}>
      <div className="field-label">
        <span>{held.label}</span>
        <Help subject={held.label}>{held.documentation}</Help>
      </div>
      <ul className="values" aria-label={held.label}>
        {held.elements.map((each, index) => (
          <li key={each.element}>
            <button type="button" className="link" onClick={() => onJump(each.element)}>
              {each.label} <small>{each.kind}</small>
            </button>
            {!readonly && (
              <span className="buttons">
                {mayMove && (
                  <>
                    <button
                      type="button"
                      className="small"
                      aria-label={`Move ${each.label} up`}
                      disabled={index === 0}
                      onClick={() => onMove(each.element, index - 1)}
                    >
                      ↑
                    </button>
                    <button
                      type="button"
                      className="small"
                      aria-label={`Move ${each.label} down`}
                      disabled={index === held.elements.length - 1}
                      onClick={() => onMove(each.element, index + 1)}
                    >
                      ↓
                    </button>
                  </>
                )}
                <button
                  type="button"
                  className="small"
                  aria-label={`Delete ${each.label}`}
                  onClick={() => onRemove(each.element, each.label)}
                >
                  ×
                </button>
              </span>
            )}
            {each.cells && each.cells.length > 0 && (
              <span className="cells">
                {each.cells.map((field) => (
                  <ValueInput
                    key={field.feature}
                    element={each.element}
                    of={each.label}
                    field={{ ...field, default: field.default || field.label }}
                    index={0}
                    label={`${field.label} of ${each.label}`}
                    describedBy={`${id}-fault`}
                    isWrong={false}
                    onFault={setFault}
                    onChange={async (value) => {
                      const why = await onSet(each, field, value === "" ? [] : [value]);
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
            <select
              aria-label={`Kind to add to ${held.label}`}
              title={chosen.documentation}
              value={chosen.kind}
              onChange={(event) => setKind(event.currentTarget.value)}
            >
              {held.kinds.map((each) => (
                <option key={each.kind} value={each.kind}>
                  {each.label}
                </option>
              ))}
            </select>
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
