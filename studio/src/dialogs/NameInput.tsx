import { useEffect } from "react";
import { useName } from "./useName";

interface Props {
  /** Null until it is known. */
  name: string | null;
  onDone(name: string): void;
  onCancel(): void;
}

/** A name that is being changed in place: Enter keeps it, Escape does not. */
export function NameInput({ name, onDone, onCancel }: Props) {
  const { field, text, setText, take } = useName(name, onDone);

  // The keyboard goes on in the diagram: else it stands nowhere once this is gone.
  useEffect(() => {
    const diagram = field.current?.closest<HTMLElement>(".flow");
    return () => {
      if (document.activeElement === document.body) diagram?.focus({ preventScroll: true });
    };
  }, [field]);

  return (
    <input
      ref={field}
      className="name nodrag nopan"
      aria-label="New name"
      // biome-ignore lint/a11y/noAutofocus: whoever asked to rename wants to type
      autoFocus
      spellCheck={false}
      value={text}
      onChange={(event) => setText(event.currentTarget.value)}
      onBlur={() => (text.trim() === (name ?? "") ? onCancel() : take())}
      onKeyDown={(event) => {
        event.stopPropagation();
        if (event.key === "Escape") onCancel();
        if (event.key === "Enter") take();
      }}
    />
  );
}
