import { fireEvent, render, screen } from "@testing-library/preact";
import userEvent from "@testing-library/user-event";
import { beforeEach, describe, expect, it, vi } from "vitest";
import { asProperties, keptSizes, Splitter } from "./Splitter";

beforeEach(() => localStorage.clear());

function show(side: "left" | "form" | "bottom", onFold?: () => void) {
  const onSize = vi.fn();
  render(<Splitter side={side} label="border" size={240} onSize={onSize} onFold={onFold} />);
  return onSize;
}

describe("borders between panels", () => {
  it("are moved by arrow keys, each in its own direction", async () => {
    const onSize = show("form");
    screen.getByRole("separator", { name: "border" }).focus();
    await userEvent.keyboard("{ArrowLeft}{ArrowRight}{ArrowUp}");
    expect(onSize.mock.calls).toEqual([[264], [216]]);
  });

  it("are moved by mouse, within limits", () => {
    const onSize = show("left");
    const bar = screen.getByRole("separator");
    bar.setPointerCapture = () => undefined;
    fireEvent.pointerDown(bar, { clientX: 240, pointerId: 1 });
    fireEvent.pointerMove(bar, { clientX: 300 });
    fireEvent.pointerMove(bar, { clientX: 0 });
    fireEvent.pointerUp(bar);
    fireEvent.pointerMove(bar, { clientX: 500 });
    expect(onSize.mock.calls).toEqual([[300], [120]]);
  });

  it("fold what they stand before on Enter", async () => {
    const onFold = vi.fn();
    show("bottom", onFold);
    screen.getByRole("separator").focus();
    await userEvent.keyboard("{Enter}");
    expect(onFold).toHaveBeenCalledTimes(1);
  });
});

describe("sizes", () => {
  it("are remembered, and nonsense is not", () => {
    localStorage.setItem("jausml-sizes", JSON.stringify({ left: 300, form: -4, bottom: "x" }));
    expect(keptSizes(localStorage)).toMatchObject({ left: 300, form: 330, bottom: 240 });
    localStorage.setItem("jausml-sizes", "{");
    expect(keptSizes(localStorage).left).toBe(240);
  });

  it("leave the tabs when folded, and give texts more room", () => {
    const sizes = { ...keptSizes(localStorage), isFolded: true };
    expect(asProperties(sizes, "source")).toEqual({
      "--left": "240px",
      "--right": "480px",
      "--bottom": "34px",
    });
  });
});
