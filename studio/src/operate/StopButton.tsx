import { useEffect } from "react";
import { nameOfKey } from "../keyboard/keys";
import { hasRight, stop, useUnit } from "./unit";

/** Keys that stop, wherever the focus is. */
const STOP_KEYS = ["F8", "Pause"];

/** The stop: always in the same place, and by a key that no field or dialog takes away. */
export function StopButton() {
  const word = useUnit((unit) => unit.state?.stop ?? "");
  const stopping = useUnit((unit) => unit.stopping);
  const now = useUnit((unit) => unit.now);
  useEffect(() => {
    function onKey(event: KeyboardEvent) {
      if (!STOP_KEYS.includes(nameOfKey(event)) || event.repeat) return;
      event.preventDefault();
      event.stopPropagation();
      void stop();
    }
    if (!hasRight()) return;
    // Before anything else sees it.
    window.addEventListener("keydown", onKey, { capture: true });
    return () => window.removeEventListener("keydown", onKey, { capture: true });
  }, []);
  if (!hasRight()) return null;
  const waiting = stopping && !stopping.outcome;
  const seconds = stopping ? Math.max(0, (now - stopping.since) / 1000).toFixed(1) : "";
  return (
    <div className="stop">
      <button
        type="button"
        className={waiting ? "stop-button pressed" : "stop-button"}
        aria-keyshortcuts="F8"
        onClick={() => void stop()}
      >
        STOP <small>{waiting ? `pressed ${seconds} s ago` : `${word} · F8`}</small>
      </button>
      <output aria-live="assertive">
        {stopping && (stopping.outcome || "Pressed: no answer yet.")}
      </output>
    </div>
  );
}
