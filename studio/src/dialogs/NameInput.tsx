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
