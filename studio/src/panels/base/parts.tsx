import { type ReactNode, useEffect, useId, useState } from "react";

const SIGNS: Record<string, string> = { ok: "✔", error: "✖", warning: "▲", info: "●" };

/** What takes the keyboard in a form, for `querySelector`. */
export const FIELDS = "input, select, textarea, button";

/** How grave a finding is, or how well a part runs: a sign and a word, never a colour alone. */
export function Level({ level }: { level: string }) {
  return (
    <span className={`level level-${level.replace(" ", "-")}`}>
      <span aria-hidden="true">{SIGNS[level] ?? "◌"}</span> {level}
    </span>
  );
}

/** What is wrong, beside the thing that is wrong. */
export function Messages({ id, messages }: { id?: string; messages: readonly string[] }) {
  return (
    <ul className="fault" id={id} hidden={messages.length === 0}>
      {messages.map((message) => (
        <li key={message}>
          <span aria-hidden="true">✖</span> {message}
        </li>
      ))}
    </ul>
  );
}

/** A button that shows and hides a text about its subject; by mouse, touch and keyboard alike. */
export function Help({ subject, children }: { subject: string; children: string }) {
  const [isOpen, setOpen] = useState(false);
  const id = useId();
  if (!children) return null;
  return (
    <>
      <button
        type="button"
        className="help-button"
        aria-expanded={isOpen}
        aria-controls={id}
        aria-label={`What is ${subject}?`}
        onClick={() => setOpen(!isOpen)}
        onKeyDown={(event) => {
          if (event.key !== "Escape" || !isOpen) return;
          event.stopPropagation();
          setOpen(false);
        }}
      >
        ?
      </button>
      <p className="help-text" id={id} hidden={!isOpen}>
        {children}
      </p>
    </>
  );
}

interface CopyableProps {
  label: string;
  text: string;
  /** What is copied where that is another text than the one that is shown. */
  copied?: string;
}

/** A text to be copied, and the button that does it. */
export function Copyable({ label, text, copied = text }: CopyableProps) {
  const [isCopied, setCopied] = useState(false);
  useEffect(() => {
    if (!isCopied) return;
    const timer = setTimeout(() => setCopied(false), 2000);
    return () => clearTimeout(timer);
  }, [isCopied]);
  return (
    <div className="copyable">
      <code>{text}</code>
      <button
        type="button"
        aria-label={`Copy ${label}`}
        onClick={() => navigator.clipboard.writeText(copied).then(() => setCopied(true))}
      >
        {isCopied ? "Copied" : "Copy"}
      </button>
    </div>
  );
}

/** The head of a table. */
export function Head({ columns }: { columns: readonly string[] }) {
  return (
    <thead>
      <tr>
        {columns.map((column) => (
          <th key={column} scope="col">
            {column}
          </th>
        ))}
      </tr>
    </thead>
  );
}

interface SelectProps {
  id?: string;
  label: string;
  title?: string;
  value: string | number;
  /** Values with what they are called. */
  options: readonly (readonly [string | number, string])[];
  onChoose(value: string): void;
}

/** One of several to be chosen. */
export function Select({ id, label, title, value, options, onChoose }: SelectProps) {
  return (
    <select
      id={id}
      aria-label={label}
      title={title}
      value={value}
      onChange={(event) => onChoose(event.currentTarget.value)}
    >
      {options.map(([choice, name]) => (
        <option key={choice} value={choice}>
          {name}
        </option>
      ))}
    </select>
  );
}

/** What stands first where nothing is chosen yet. */
export const CHOOSE = ["", "choose…"] as const;

interface OrderProps {
  /** How people call what is moved. */
  name: string;
  at: number;
  count: number;
  /** Moves it, where it may be moved. */
  onMove?: ((to: number) => void) | undefined;
  onRemove(): void;
}

/** Buttons that move one of a list, and take it away. */
export function Order({ name, at, count, onMove, onRemove }: OrderProps) {
  const button = (sign: string, label: string, isOff: boolean, work: () => void) => (
    <button type="button" className="small" aria-label={label} disabled={isOff} onClick={work}>
      {sign}
    </button>
  );
  return (
    <span className="buttons">
      {onMove && (
        <>
          {button("↑", `Move ${name} up`, at === 0, () => onMove(at - 1))}
          {button("↓", `Move ${name} down`, at === count - 1, () => onMove(at + 1))}
        </>
      )}
      {button("×", `Remove ${name}`, false, onRemove)}
    </span>
  );
}

/** What a panel says when it has nothing to show. */
export function Quiet({ children }: { children: ReactNode }) {
  return <p className="quiet">{children}</p>;
}

/** Why something did not work. */
export function Fault({ children }: { children: string }) {
  if (!children) return null;
  return (
    <p className="fault" role="alert">
      <Level level="error" /> {children}
    </p>
  );
}

/** The local time of day of seconds since 1970. */
export const clock = (seconds: number): string =>
  new Date(1000 * seconds).toTimeString().slice(0, 8);

/** Numbers as people read them: three figures that count. */
export function figure(value: number | null | undefined, unit = ""): string {
  if (value === null || value === undefined) return "–";
  const text =
    Math.abs(value) >= 100 ? String(Math.round(value)) : String(Number(value.toPrecision(3)));
  return unit ? `${text} ${unit}` : text;
}
