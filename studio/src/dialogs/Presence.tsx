import { useState } from "react";
import { calledOf, callMe, othersOf, ownName, reveal } from "../actions";
import { useStudio } from "../store";
import { Modal } from "./Modal";

/** Who else has the project open, where they look, and how one wants to be called oneself. */
export function Presence({ onClose }: { onClose(): void }) {
  const studio = useStudio();
  const others = othersOf(studio);
  const [name, setName] = useState(ownName);
  return (
    <Modal title="Who else is here" onClose={onClose}>
      <ul className="others">
        {others.map((each) => (
          <li key={each.id}>
            <strong>{calledOf(each)}</strong>
            {each.name && !each.here && " (in another studio)"}{" "}
            {each.file ? `looks at ${each.file}, ${each.view}` : "looks at nothing"}{" "}
            {each.element && (
              <button
                type="button"
                className="link"
                onClick={() => {
                  onClose();
                  void reveal(each.element, each.file);
                }}
              >
                Show what is chosen there
              </button>
            )}
          </li>
        ))}
        {others.length === 0 && <li>Nobody else has this project open.</li>}
      </ul>
      <form
        onSubmit={(event) => {
          event.preventDefault();
          callMe(name);
          onClose();
        }}
      >
        <label>
          Your name, as others here see it{" "}
          <input
            value={name}
            maxLength={40}
            autoComplete="off"
            onChange={(event) => setName(event.currentTarget.value)}
          />
        </label>
        <footer>
          <button type="submit" className="best">
            Use this name
          </button>
        </footer>
      </form>
    </Modal>
  );
}
