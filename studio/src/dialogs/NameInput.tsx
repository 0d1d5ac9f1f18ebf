import { useState } from "react";

interface Props {
  name: string;
  onDone(name: string): void;
  onCancel(): void;
}

/** A name that is being changed in place: Enter keeps it, Escape does not. */
export function NameInput({ name, onDone, onCancel }: Props) {
  const [text, setText] = useState(name);
  return (
    <input
      className="name nodrag nopan"
      aria-label="New name"
      // biome-ignore lint/a11y/noAutofocus: whoever asked to rename wants to type
      autoFocus
      spellCheck={false}
      value={text}
      onFocus={(event) => event.currentTarget.select()}
      onChange={(event) => setText(event.currentTarget.value)}
      onBlur={() => (text.trim() === name ? onCancel() : onDone(text.trim()))}
      onKeyDown={(event) => {
        event.stopPropagation();
        if (event.key === "Escape") onCancel();
        if (event.key === "Enter") onDone(text.trim());
      }}
    />
  );
}
