import { type KeyboardEvent, useEffect, useId, useLayoutEffect, useRef, useState } from "react";
import { draftOf, dropDraft, keepDraft } from "../../actions";
import type { FormField, Ref } from "../../protocol";
import { Combobox } from "../base/Combobox";
import { fault, shownAs } from "./values";

interface Props {
  id?: string;
  element: Ref;
  /** How people call the element. */
  of: string;
  field: FormField;
  /** Which value of the field; past the last one: a new one. */
  index: number;
  label: string;
  describedBy: string;
  isWrong: boolean;
  /** Takes the new value; what it returns, or resolves to, is why it was refused. */
  onChange: (value: string) => unknown;
  onFault: (message: string) => void;
}

/** The control of one value of a field. */
export function ValueInput(props: Props) {
  switch (props.field.kind) {
    case "boolean":
      return <Checkbox {...props} />;
    case "choice":
      return <Select {...props} />;
    case "reference":
      return <Reference {...props} />;
    default:
      return <Typed {...props} />;
  }
}

function Checkbox({ id, field, index, label, describedBy, onChange }: Props) {
  const value = field.values[index] ?? (field.many ? "false" : field.default);
  return (
    <input
      id={id}
      type="checkbox"
      aria-label={label}
      aria-describedby={describedBy}
      disabled={!field.changeable}
      checked={value === "true"}
      onChange={({ currentTarget }) => {
        const wanted = currentTarget.checked;
        currentTarget.checked = value === "true"; // until the model has it, which may be refused
        onChange(wanted ? "true" : "false");
      }}
    />
  );
}

function Select({ id, field, index, label, describedBy, isWrong, onChange }: Props) {
  const value = field.values[index] ?? "";
  const usual =
    field.choices.find((choice) => choice.value === field.default)?.label ?? field.default;
  const chosen = field.choices.find((choice) => choice.value === (value || field.default));
  const isKnown = value === "" || field.choices.some((choice) => choice.value === value);
  return (
    <div className="chooser">
      <select
        id={id}
        aria-label={label}
        aria-describedby={describedBy}
        aria-invalid={isWrong || undefined}
        disabled={!field.changeable}
        value={value}
        onChange={({ currentTarget }) => {
          const wanted = currentTarget.value;
          currentTarget.value = value; // until the model has it, which may be refused
          onChange(wanted);
        }}
      >
        <option value="">{usual ? `${usual} (default)` : "– none –"}</option>
        {!isKnown && <option value={value}>{value}</option>}
        {field.choices.map((choice) => (
          <option key={choice.value} value={choice.value}>
            {choice.label}
          </option>
        ))}
      </select>
      {chosen?.documentation && <small className="quiet">{chosen.documentation}</small>}
    </div>
  );
}

function Reference({ id, element, field, index, label, describedBy, isWrong, onChange }: Props) {
  return (
    <Combobox
      {...(id === undefined ? {} : { id })}
      label={label}
      element={element}
      feature={field.feature}
      shown={shownAs(field, index)}
      placeholder={field.default || "type to search"}
      disabled={!field.changeable}
      isWrong={isWrong}
      describedBy={describedBy}
      onChoose={onChange}
    />
  );
}

/** What is typed. */
interface Typing {
  text: string;
  /** It was handed on, and is not to be handed on again when the focus goes. */
  isSent: boolean;
  /** What stood there when it was begun, and what the model had. */
  over: string;
  given: string;
}

function Typed(props: Props) {
  const { id, element, of, field, index, label, describedBy, isWrong, onChange, onFault } = props;
  const current = field.values[index] ?? "";
  const place = `${field.feature} ${index}`;
  const [typed, setDraft] = useState<Typing | null>(() => {
    const text = draftOf(element, place)?.text;
    return text === undefined || text === current
      ? null
      : { text, isSent: false, over: current, given: current };
  });
  const isShown = useKept(typed, (text) => {
    keepDraft({ element, field: place, what: `${label} of ${of}`, text, why: fault(field, text) });
  });
  useEffect(() => {
    const kept = draftOf(element, place);
    if (kept) onFault(kept.why || fault(field, kept.text));
    dropDraft(element, place); // it is in the field now
  }, [element, place, field, onFault]);
  const [known, setKnown] = useState(field.values);
  const usual = useId();
  const shown = typed?.text ?? current;
  // A new answer of the server wins over what was sent before it came, even where it says what
  // the last one said: then the edit was undone meanwhile. What was not sent yet is never lost.
  if (known !== field.values) {
    setKnown(field.values);
    if (typed?.isSent) setDraft(null);
  }
  const isOvertaken =
    typed !== null && !typed.isSent && current !== typed.given && current !== typed.over;

  function type(text: string) {
    const begun = typed !== null && !typed.isSent ? typed : { over: shown, given: current };
    setDraft({ text, isSent: false, over: begun.over, given: begun.given });
  }

  function commit() {
    if (typed === null || typed.isSent) return;
    const isNumber = field.kind === "number" || field.kind === "integer";
    const text = isNumber ? typed.text.trim() : typed.text;
    if (text === current) return restore();
    const why = fault(field, text);
    onFault(why);
    if (why) return;
    const sent = { ...typed, isSent: true };
    setDraft(sent);
    // What was refused may be sent again, unless something else was typed meanwhile.
    void Promise.resolve(onChange(text)).then((refusal) => {
      if (!refusal) return;
      if (isShown.current) setDraft((now) => (now === sent ? { ...sent, isSent: false } : now));
      else keepDraft({ element, field: place, what: `${label} of ${of}`, text, why: `${refusal}` });
    });
  }

  function restore() {
    setDraft(null);
    onFault("");
  }

  function onKeyDown(event: KeyboardEvent) {
    if (event.key === "Escape" && typed !== null) {
      event.stopPropagation();
      restore();
    }
    if (event.key === "Enter" && (field.kind !== "multiline" || event.ctrlKey || event.metaKey)) {
      event.preventDefault();
      commit();
    }
  }

  const common = {
    id,
    "aria-label": label,
    "aria-describedby": describedBy,
    "aria-invalid": isWrong || undefined,
    "aria-required": field.required || undefined,
    readOnly: !field.changeable,
    placeholder: field.default,
    value: shown,
    onBlur: commit,
    onKeyDown,
  };
  if (field.kind === "multiline")
    return <textarea {...common} rows={3} onChange={(event) => type(event.currentTarget.value)} />;
  const isNumber = field.kind === "number" || field.kind === "integer";
  return (
    <>
      {isOvertaken && <small className="quiet">meanwhile it became {current || "empty"}</small>}
      <input
        {...common}
        type="text"
        list={field.choices.length > 0 ? usual : undefined}
        autoComplete="off"
        inputMode={isNumber ? "decimal" : "text"}
        spellCheck="false"
        onChange={(event) => type(event.currentTarget.value)}
      />
      {field.choices.length > 0 && (
        <datalist id={usual}>
          {field.choices.map((choice) => (
            <option key={choice.value} value={choice.value}>
              {choice.documentation || choice.label}
            </option>
          ))}
        </datalist>
      )}
    </>
  );
}

/**
 * Keeps what is typed and was not taken when the field goes, as when another element is chosen, or
 * the page.
 *
 * @returns Whether the field is there.
 */
function useKept(typed: Typing | null, keep: (text: string) => void) {
  const last = useRef({ typed, keep });
  const isShown = useRef(true);
  // At once: it may go before the next frame.
  useLayoutEffect(() => {
    last.current = { typed, keep };
  });
  useLayoutEffect(() => {
    isShown.current = true;
    const leave = () => {
      const { typed, keep } = last.current;
      if (typed && !typed.isSent) keep(typed.text);
    };
    window.addEventListener("pagehide", leave);
    return () => {
      window.removeEventListener("pagehide", leave);
      isShown.current = false;
      leave();
    };
  }, []);
  return isShown;
}
