import { render, screen } from "@testing-library/preact";
import userEvent from "@testing-library/user-event";
import { expect, it } from "vitest";
import type { Plan } from "../../protocol";
import { serve } from "../../testing/fakeServer";
import { kindOf } from "../base/Diff";
import { Generate, quoted } from "./Generate";

const PLAN: Plan = {
  out: "robot_ws/src",
  files: [
    { path: "bridge/main.py", action: "create", reason: "" },
    { path: "bridge/mine.py", action: "keep", reason: "" },
    { path: "bridge/old.py", action: "same", reason: "" },
  ],
  drift: [],
  problems: "",
  digest: "d1",
};
const REFUSING: Plan = {
  ...PLAN,
  files: [...PLAN.files, { path: "bridge/edited.py", action: "refuse", reason: "it was edited" }],
  drift: [
    { path: "vehicle.py", line: 7, severity: "warning", message: "it lacks on_stop", stub: "" },
  ],
};

function show(plan: Plan) {
  const server = serve({
    plan: () => plan,
    diff: () => ({
      diff: "--- a\n+++ b\n@@ -1 +1 @@\n-old <b>\n+new <script>alert(1)</script>\n same\n",
    }),
    generate: () => ({ written: 1, message: "1 file written." }),
  });
  render(<Generate />);
  return server;
}

it("shows what would happen to which file", async () => {
  show(REFUSING);
  expect(await screen.findByText("1 to create")).toBeVisible();
  expect(screen.getByText("1 refused")).toBeVisible();
  expect(screen.getByText("1 to keep")).toBeVisible();
  expect(screen.getByText(/vehicle.py:7: it lacks on_stop/)).toBeVisible();
  expect(screen.getByText("jausml run robot_ws/src")).toBeVisible();
});

it("offers to run what exists alone", async () => {
  show({ ...PLAN, files: PLAN.files.slice(0, 1) });
  expect(await screen.findByText("1 to create")).toBeVisible();
  expect(screen.queryByText(/jausml run/)).toBeNull();
});

it("shows the diff of a file as text", async () => {
  show(PLAN);
  await userEvent.click(await screen.findByRole("button", { name: "bridge/main.py" }));
  const added = await screen.findByText("+new <script>alert(1)</script>");
  expect(added).toHaveClass("diff-added");
  expect(screen.getByText("-old <b>")).toHaveClass("diff-removed");
  expect(document.querySelector("pre script, pre b")).toBeNull();
});

it("generates what was shown", async () => {
  const server = show(PLAN);
  await screen.findByText("1 to create");
  await userEvent.click(screen.getByRole("button", { name: "Generate" }));
  expect(server.params("generate")).toEqual([
    { file: "robot.xmi", out: "robot_ws/src", digest: "d1", force: false },
  ]);
  expect(await screen.findByText("1 file written.")).toBeVisible();
});

it("generates nothing while files are refused, unless they may be overwritten", async () => {
  const server = show(REFUSING);
  await screen.findByText("1 to create");
  expect(screen.getByRole("button", { name: "Generate" })).toBeDisabled();
  server.answer("plan", () => PLAN);
  await userEvent.click(screen.getByRole("checkbox", { name: /Overwrite/ }));
  expect(server.params("plan").at(-1)).toMatchObject({ force: true });
  await userEvent.click(await screen.findByRole("button", { name: "Generate" }));
  expect(server.params("generate")).toMatchObject([{ force: true }]);
});

it("plans for another folder", async () => {
  const server = show(PLAN);
  await screen.findByText("1 to create");
  await userEvent.type(screen.getByLabelText("Folder"), "my out{Enter}");
  expect(server.params("plan").at(-1)).toEqual({ file: "robot.xmi", out: "my out", force: false });
});

it("does nothing while there are problems, or nothing to do", async () => {
  show({ ...PLAN, problems: "2 errors in the model" });
  expect(await screen.findByRole("alert")).toHaveTextContent("2 errors in the model");
  expect(screen.getByRole("button", { name: "Generate" })).toBeDisabled();
});

it("writes words of a shell", () => {
  expect(quoted("robot_ws/src")).toBe("robot_ws/src");
  expect(quoted("my out's")).toBe(`'my out'\\''s'`);
});

it("knows the lines of a diff", () => {
  expect(["+a", "-a", " a", "@@ -1 +1 @@", "+++ b", "--- a"].map(kindOf)).toEqual([
    "added",
    "removed",
    "same",
    "place",
    "place",
    "place",
  ]);
});
