import { update } from "../store";

/** What to do where there is nothing yet. */
export function EmptyHint() {
  return (
    <div className="hint">
      <p>
        <strong>There is nothing here yet.</strong>
      </p>
      <p>
        Drag a component, a bridge or a node from the palette on the left to this place, or search
        there by name and press Enter. <kbd>?</kbd> shows all keys.
      </p>
      <button type="button" onClick={() => update({ dialog: { kind: "help" } })}>
        Show the keys
      </button>
    </div>
  );
}
