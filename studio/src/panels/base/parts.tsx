import { type ReactNode, useEffect, useId, useState } from "react";

const SIGNS: Record<string, string> = { ok: "✔", error: "✖", warning: "▲", info: "●" };

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
      {messages.map((each) => (
        <li key={each}>
          <span aria-hidden="true">✖</span> {each}
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

/** Numbers as people read them: three figures that count. */
export function figure(value: number | null | undefined, unit = ""): string {
  if (value === null || value === undefined) return "–";
  const text =
    Math.abs(value) >= 100 ? String(Math.round(value)) : String(Number(value.toPrecision(3)));
  return unit ? `${text} ${unit}` : text;
}
