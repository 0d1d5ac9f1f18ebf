import { useId, useState } from "react";
import type { FormField, Ref } from "../../protocol";
import { Help, Messages, Order } from "../base/parts";
import { ValueInput } from "./ValueInput";
import { moved, shownAs } from "./values";

interface Props {
  element: Ref;
  /** How people call the element. */
  of: string;
  field: FormField;
  /** Sets all values of the field; none unsets it. Resolves to why it was refused, or nothing. */
  onSet: (values: string[]) => Promise<string>;
  onJump: (element: string) => void;
}

/** A feature of an element: label, value or list of values, help and what is wrong with it. */
export function FieldRow({ element, of, field, onSet, onJump }: Props) {
  const [why, setWhy] = useState("");
  const id = useId();
  const problems = [...(why ? [why] : []), ...field.problems];
  const isWrong = problems.length > 0;

  async function set(values: string[]): Promise<string> {
    const refusal = await onSet(values);
    setWhy(refusal);
    return refusal;
  }

  const shared = { element, of, field, describedBy: `${id}-problems`, isWrong, onFault: setWhy };
  const isSet = field.values.length > 0;
  return (
    <div className={`field field-${field.kind}`} data-feature={field.feature}>
      <div className="field-label">
        {field.many ? (
          <span id={`${id}-label`}>{field.label}</span>
        ) : (
          <label htmlFor={id}>{field.label}</label>
        )}
        {field.required && (
          <small className="quiet" title="must have a value">
            required
          </small>
        )}
        {field.unit && <small className="quiet">{field.unit}</small>}
        <Help subject={field.label}>{field.documentation}</Help>
      </div>
      {field.many ? (
        <Values {...shared} labelledBy={`${id}-label`} onSet={set} onJump={onJump} />
      ) : (
        <div className="field-value">
          <ValueInput
            {...shared}
            id={id}
            index={0}
            label={field.label}
            onChange={(value) => set(value === "" ? [] : [value])}
          />
          {field.kind === "reference" && isSet && (
            <Jump label={shownAs(field, 0)} onJump={() => onJump(field.values[0] ?? "")} />
          )}
          {isSet && field.changeable && !field.required && field.kind !== "choice" && (
            <button
              type="button"
              className="small"
              aria-label={`Unset ${field.label}`}
              onClick={() => set([])}
            >
              ×
            </button>
          )}
        </div>
      )}
      <div aria-live="polite">
        <Messages id={`${id}-problems`} messages={problems} />
      </div>
    </div>
  );
}

interface ListProps {
  element: Ref;
  of: string;
  field: FormField;
  labelledBy: string;
  describedBy: string;
  isWrong: boolean;
  onSet: (values: string[]) => Promise<string>;
  onFault: (message: string) => void;
  onJump: (element: string) => void;
}

function Values({ labelledBy, onSet, onJump, ...rest }: ListProps) {
  const { field } = rest;
  const { values } = field;
  const replaced = (index: number, value: string) =>
    values.map((other, at) => (at === index ? value : other));
  return (
    <ol className="values" aria-labelledby={labelledBy}>
      {values.map((value, index) => (
        // biome-ignore lint/suspicious/noArrayIndexKey: values may be equal, and are told apart by their place
        <li key={index}>
          {field.kind === "reference" ? (
            <Jump label={shownAs(field, index)} onJump={() => onJump(value)} isWide />
          ) : (
            <ValueInput
              {...rest}
              index={index}
              label={`${field.label}, value ${index + 1}`}
              onChange={(text) =>
                onSet(text === "" ? values.filter((_, at) => at !== index) : replaced(index, text))
              }
            />
          )}
          {field.changeable && (
            <Order
              name={shownAs(field, index)}
              at={index}
              count={values.length}
              onMove={(to) => onSet(moved(values, index, to))}
              onRemove={() => onSet(values.filter((_, at) => at !== index))}
            />
          )}
        </li>
      ))}
      {field.changeable && (
        <li key={`new ${values.length}`}>
          <ValueInput
            {...rest}
            field={{ ...field, required: false, default: "add…" }}
            index={values.length}
            label={`Add to ${field.label}`}
            onChange={(value) => value !== "" && onSet([...values, value])}
          />
        </li>
      )}
    </ol>
  );
}

function Jump({
  label,
  onJump,
  isWide = false,
}: {
  label: string;
  onJump: () => void;
  isWide?: boolean;
}) {
  return (
    <button
      type="button"
      className={isWide ? "link" : "small"}
      aria-label={`Go to ${label}`}
      title={`Go to ${label}`}
      onClick={onJump}
    >
      {isWide ? label : "→"}
    </button>
  );
}
