import { useState } from "react";
import type { ChildKind, FormChildren, Ref } from "../../protocol";
import { Help } from "../base/parts";

interface Props {
  held: FormChildren;
  readonly: boolean;
  onAdd: (kind: ChildKind) => void;
  onRemove: (element: Ref, label: string) => void;
  onMove: (element: Ref, position: number) => void;
  onJump: (element: Ref) => void;
}

/** What an element holds under one feature: go to it, add, move and remove. */
export function ChildrenRow({ held, readonly, onAdd, onRemove, onMove, onJump }: Props) {
  const [kind, setKind] = useState("");
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
          </li>
        ))}
      </ul>
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
          <button type="button" title={chosen.documentation} onClick={() => onAdd(chosen)}>
            Add {chosen.label}
          </button>
        </div>
      )}
    </div>
  );
}
