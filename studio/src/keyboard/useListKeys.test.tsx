import { render, screen } from "@testing-library/preact";
import userEvent from "@testing-library/user-event";
import { expect, test, vi } from "vitest";
import { useListKeys } from "./useListKeys";

function List({ names, onTake }: { names: string[]; onTake: (at: number) => void }) {
  const { active, onKey } = useListKeys(names.length, onTake);
  return <input aria-label="field" data-active={names[active] ?? "none"} onKeyDown={onKey} />;
}

const active = () => screen.getByLabelText("field").dataset.active;

test("arrows go round, Enter takes what is active", async () => {
  const onTake = vi.fn();
  const { rerender } = render(<List names={["a", "b", "c"]} onTake={onTake} />);
  await userEvent.type(screen.getByLabelText("field"), "{ArrowDown}");
  expect(active()).toBe("b");
  await userEvent.keyboard("{ArrowUp}{ArrowUp}");
  expect(active()).toBe("c");
  await userEvent.keyboard("{ArrowDown}");
  expect(active()).toBe("a");
  await userEvent.keyboard("{ArrowUp}{Enter}");
  expect(onTake).toHaveBeenCalledWith(2);
  // A list that has become shorter has its last one active.
  rerender(<List names={["a", "b"]} onTake={onTake} />);
  expect(active()).toBe("b");
});

test("of an empty list nothing is taken", async () => {
  const onTake = vi.fn();
  render(<List names={[]} onTake={onTake} />);
  await userEvent.type(screen.getByLabelText("field"), "{ArrowDown}{Enter}");
  expect(active()).toBe("none");
  expect(onTake).not.toHaveBeenCalled();
});
