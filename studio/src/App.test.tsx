import { render, screen } from "@testing-library/preact";
import userEvent from "@testing-library/user-event";
import { expect, test } from "vitest";
import { App } from "./App";
import { state } from "./store";
import { serve } from "./testing/fakeServer";

test("the page names its file, and its tabs are reached by arrows", async () => {
  serve();
  render(<App />);
  expect(screen.getByLabelText("File")).toHaveValue("robot.xmi");
  const tab = screen.getByRole("tab", { name: "Problems" });
  tab.focus();
  await userEvent.keyboard("{ArrowRight}");
  expect(state().bottom).toBe("generate");
  expect(screen.getByRole("tab", { name: "Generate" })).toHaveFocus();
});
