import { useEffect } from "react";
import { nameOfKey } from "../keyboard/keys";
import { stop, useUnit } from "./unit";

/** Keys that stop, wherever the focus is. */
const STOP_KEYS = ["F8", "Pause"];

/** The stop: always in the same place, and by a key that no field or dialog takes away. */
export function StopButton() {
  const word = useUnit((unit) => unit.state?.stop ?? "");
  const mayCommand = useUnit((unit) => unit.mayCommand);
  useEffect(() => {
    function onKey(event: KeyboardEvent) {
      if (!STOP_KEYS.includes(nameOfKey(event)) || event.repeat) return;
      event.preventDefault();
      event.stopPropagation();
      void stop();
    }
    // Before anything else sees it.
    window.addEventListener("keydown", onKey, { capture: true });
    return () => window.removeEventListener("keydown", onKey, { capture: true });
  }, []);
  if (!mayCommand) return null;
  return (
    <button
      type="button"
      className="stop-button"
      aria-keyshortcuts="F8"
      onClick={() => void stop()}
    >
      STOP <small>{word} · F8</small>
    </button>
  );
}
