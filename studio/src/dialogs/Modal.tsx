import { type ReactNode, useId, useLayoutEffect, useRef } from "react";

interface Props {
  title: string;
  onClose(): void;
  children: ReactNode;
  isWide?: boolean;
  /** Whether it is gone before one looks, as a rule: it holds the keys at once, and is seen later. */
  isShort?: boolean;
}

const FIRST = "input, [role='listbox'][tabindex='0'], .best";

/** A dialog that holds the focus until it is closed, and gives it back. */
export function Modal({ title, onClose, children, isWide = false, isShort = false }: Props) {
  const dialog = useRef<HTMLDialogElement>(null);
  const id = useId();
  // Before anything else happens: the next key is for the dialog.
  useLayoutEffect(() => {
    const element = dialog.current;
    const before = document.activeElement;
    if (element && !element.open) {
      element.showModal();
      // It would begin with the first button, which closes it.
      (element.querySelector<HTMLElement>(FIRST) ?? element).focus();
    }
    return () => {
      element?.close();
      if (before instanceof HTMLElement && before.isConnected) before.focus();
    };
  }, []);
  return (
    <dialog
      ref={dialog}
      tabIndex={-1}
      className={isWide ? "wide" : isShort ? "short" : ""}
      aria-labelledby={id}
      onCancel={(event) => {
        event.preventDefault();
        onClose();
      }}
      onKeyDown={(event) => {
        event.stopPropagation();
        if (event.key === "Escape") onClose();
      }}
    >
      <header>
        <h2 id={id}>{title}</h2>
        <button type="button" aria-label="Close" onClick={onClose}>
          ×
        </button>
      </header>
      {children}
    </dialog>
  );
}
