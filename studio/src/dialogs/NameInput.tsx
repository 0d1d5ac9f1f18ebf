import { useLayoutEffect } from "react";
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

  // Whoever asked to rename wants to type. Then the keyboard goes on in the diagram: else it stands
  // nowhere once this is gone, which is a moment after it is told so.
  useLayoutEffect(() => {
    const diagram = field.current?.closest<HTMLElement>(".flow");
    field.current?.focus({ preventScroll: true });
    return () =>
      queueMicrotask(() => {
        if (document.activeElement === document.body) diagram?.focus({ preventScroll: true });
      });
  }, [field]);

  return (
    <input
      ref={field}
      className="name nodrag nopan"
      aria-label="New name"
      spellCheck="false"
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
