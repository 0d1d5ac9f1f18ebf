import { useId } from "react";
import { CHOOSE, Help, Select } from "../panels/base/parts";
import {
  asThere,
  type Draft,
  type Faults,
  isThere,
  itemsOf,
  membersOf,
  pathOf,
  rangesOf,
  textOf,
} from "./fields";
import type { Field, NumberKind } from "./protocol";

interface Shared {
  faults: Faults;
  /** Whether it was tried to send it: what is not typed yet is no fault before. */
  isTried: boolean;
}

interface FormProps extends Shared {
  fields: Field[];
  draft: Draft;
  path?: string;
  onDraft(draft: Draft): void;
}

/** The fields of a message or of a group in it. */
export function FieldsForm({ fields, draft, path = "", onDraft, ...shared }: FormProps) {
  const members = membersOf(draft);
  return (
    <div className="fields">
      {fields.map((field) => (
        <FieldInput
          key={field.name}
          field={field}
          draft={members[field.name]}
          path={pathOf(path, field.name)}
          onDraft={(inner) => onDraft({ ...members, [field.name]: inner })}
          {...shared}
        />
      ))}
    </div>
  );
}

interface Props extends Shared {
  field: Field;
  draft: Draft | undefined;
  path: string;
  onDraft(draft: Draft): void;
}

function FieldInput(props: Props) {
  const { field, draft, path, onDraft, ...shared } = props;
  const { faults, isTried } = shared;
  switch (field.kind) {
    case "group":
      return (
        <fieldset>
          <legend>
            {field.name} <Help subject={field.name}>{field.documentation}</Help>
          </legend>
          {field.optional && (
            <label>
              <input
                type="checkbox"
                checked={isThere(field, draft)}
                onChange={(event) => onDraft(asThere(draft, event.currentTarget.checked))}
              />
              send it
            </label>
          )}
          {isThere(field, draft) && (
            <FieldsForm
              fields={field.members}
              draft={draft ?? {}}
              path={path}
              onDraft={onDraft}
              {...shared}
            />
          )}
        </fieldset>
      );
    case "list":
      return <ListInput {...props} field={field} />;
    case "variant":
      return <VariantInput {...props} field={field} />;
    case "variable": {
      const members = membersOf(draft);
      const chosen = field.alternatives.find(
        (alternative) => String(alternative.index) === textOf(members.index),
      );
      return (
        <fieldset>
          <legend>{field.name}</legend>
          <Select
            label={`Type of ${field.name}`}
            value={textOf(members.index)}
            options={[
              CHOOSE,
              ...field.alternatives.map(
                ({ index, name, units }) => [index, `${name} ${units}`] as const,
              ),
            ]}
            onChoose={(index) => onDraft({ ...members, index })}
          />
          {chosen && (
            <Typed
              label={field.name}
              hint={rangesOf(chosen)}
              fault={faultOf(path, members.value, faults, isTried)}
              text={textOf(members.value)}
              onText={(value) => onDraft({ ...members, value })}
            />
          )}
        </fieldset>
      );
    }
    case "formatted": {
      const members = membersOf(draft);
      return (
        <fieldset>
          <legend>{field.name}</legend>
          <Select
            label={`Format of ${field.name}`}
            value={textOf(members.format)}
            options={[CHOOSE, ...field.formats.map(({ index, name }) => [index, name] as const)]}
            onChoose={(format) => onDraft({ ...members, format })}
          />
          <Typed
            label={`${field.name}, hexadecimal`}
            hint={`${field.least} to ${field.most} bytes`}
            fault={faultOf(path, members.hex, faults, isTried)}
            text={textOf(members.hex)}
            onText={(hex) => onDraft({ ...members, hex })}
          />
        </fieldset>
      );
    }
    case "number":
      return (
        <Typed
          label={labelOf(field)}
          help={field.documentation}
          hint={rangesOf(field)}
          choices={field}
          fault={faultOf(path, draft, faults, isTried)}
          text={textOf(draft)}
          onText={onDraft}
        />
      );
    default:
      return (
        <Typed
          label={labelOf(field)}
          help={field.documentation}
          hint={`${field.least} to ${field.most} ${field.kind === "text" ? "characters" : "bytes, hexadecimal"}`}
          fault={faultOf(path, draft, faults, isTried)}
          text={textOf(draft)}
          onText={onDraft}
        />
      );
  }
}

const labelOf = ({ name, optional }: Field): string => (optional ? `${name} (optional)` : name);

/** Why a field is wrong, once something stands in it or it was tried to send it. */
function faultOf(path: string, draft: Draft | undefined, faults: Faults, isTried: boolean): string {
  return isTried || textOf(draft) !== "" ? (faults.get(path) ?? "") : "";
}

interface TypedProps {
  label: string;
  help?: string;
  hint: string;
  choices?: NumberKind;
  fault: string;
  text: string;
  onText(text: string): void;
}

/** A field that is typed, or chosen among names where all that is legal has one. */
function Typed({ label, help, hint, choices, fault, text, onText }: TypedProps) {
  const id = useId();
  const known = choices?.choices ?? [];
  const isClosed =
    known.length > 0 &&
    (choices?.ranges ?? []).reduce((sum, [low, high]) => sum + high - low + 1, 0) <= known.length;
  return (
    <div className="typed">
      <label htmlFor={id}>{label}</label> <Help subject={label}>{help ?? ""}</Help>
      {isClosed ? (
        <Select
          id={id}
          label={label}
          value={text}
          options={[
            CHOOSE,
            ...known.map((option) => [option.value, `${option.label} (${option.value})`] as const),
          ]}
          onChoose={onText}
        />
      ) : (
        <input
          id={id}
          value={text}
          autoComplete="off"
          spellCheck="false"
          aria-invalid={fault !== ""}
          aria-describedby={`${id}-hint ${id}-fault`}
          onChange={(event) => onText(event.currentTarget.value)}
        />
      )}{" "}
      <small id={`${id}-hint`} className="quiet">
        {hint}
      </small>
      <span id={`${id}-fault`} className="fault">
        {fault && `✖ ${fault}`}
      </span>
    </div>
  );
}

function ListInput({
  field,
  draft,
  path,
  onDraft,
  ...shared
}: Props & { field: Field & { kind: "list" } }) {
  const items = itemsOf(draft);
  const fault = shared.isTried ? shared.faults.get(path) : "";
  return (
    <fieldset>
      <legend>
        {field.name} ({items.length} of {field.least} to {field.most})
      </legend>
      {items.map((item, index) => (
        // biome-ignore lint/suspicious/noArrayIndexKey: elements have no other name
        <div key={index} className="element">
          <FieldInput
            field={{ ...field.element, name: `${field.element.name} ${index + 1}` }}
            draft={item}
            path={`${path}[${index}]`}
            onDraft={(inner) => onDraft(items.with(index, inner))}
            {...shared}
          />
          <button
            type="button"
            aria-label={`Remove ${field.element.name} ${index + 1}`}
            onClick={() => onDraft(items.toSpliced(index, 1))}
          >
            ×
          </button>
        </div>
      ))}
      <button
        type="button"
        disabled={items.length >= field.most}
        onClick={() => onDraft([...items, field.element.kind === "list" ? [] : {}])}
      >
        Add {field.element.name}
      </button>
      <span className="fault">{fault && `✖ ${fault}`}</span>
    </fieldset>
  );
}

function VariantInput({
  field,
  draft,
  path,
  onDraft,
  ...shared
}: Props & { field: Field & { kind: "variant" } }) {
  const members = membersOf(draft);
  const tag = textOf(members._tag);
  const option = tag === "" ? undefined : field.options[Number(tag)];
  return (
    <fieldset>
      <legend>{field.name}</legend>
      <Select
        label={`Option of ${field.name}`}
        value={tag}
        options={[CHOOSE, ...field.options.map(({ name }, index) => [index, name] as const)]}
        onChoose={(_tag) => onDraft({ _tag })}
      />
      {option && (
        <FieldInput
          field={option}
          draft={members.value}
          path={pathOf(path, option.name)}
          onDraft={(value) => onDraft({ ...members, value })}
          {...shared}
        />
      )}
    </fieldset>
  );
}
