import { act, render, screen } from "@testing-library/preact";
import userEvent from "@testing-library/user-event";
import { afterEach, expect, it } from "vitest";
import { listener } from "../../actions";
import type { LiveState, Mark, ReadRecording } from "../../protocol";
import { state } from "../../store";
import { serve } from "../../testing/fakeServer";
import { Live } from "../live/Live";
import { close, goTo, nextMark, player } from "./player";
import Recording from "./Recording";

const drop = (time: number, kind: Mark["kind"] = "drop"): Mark => ({
  kind,
  time,
  bridge: "bridge",
  connection: "drive",
});
const READ: ReadRecording = {
  duration: 20,
  damage: "",
  sources: { ROS: "the recording has no /diagnostics" },
  unreadable: 0,
  marks: [drop(4), drop(6, "state"), drop(9)],
  unlisted: 0,
};
const STATE: LiveState = { connections: [], components: [], edges: {}, boxes: {} };

afterEach(close);

function show(recordings: string[] = ["run.mcap"]) {
  const server = serve({
    "recording.files": () => ({ files: ["run.mcap", "other.mcap"], given: recordings }),
    "recording.open": () => ({ share: 1, fault: "", read: READ }),
    "recording.state": ({ at }) => ({ at, state: { ...STATE, health: `at ${at}` } }),
    "recording.why": ({ at }) => ({ at, counter: ["It rose."], state: [] }),
  });
  render(<Recording />);
  return server;
}

it("finds the marks of a kind around a moment", () => {
  expect(nextMark(READ.marks, "drop", 4, 1)?.time).toBe(9);
  expect(nextMark(READ.marks, "drop", 4, -1)).toBeUndefined();
  expect(nextMark(READ.marks, "drop", 9, -1)?.time).toBe(4);
  expect(nextMark(READ.marks, "control", 0, 1)).toBeUndefined();
});

it("opens what was given, steps with the keys, and explains", async () => {
  show();
  const line = await screen.findByRole("slider", { name: "Moment of run.mcap" });
  expect(screen.getByRole("note")).toHaveTextContent("no /diagnostics");
  await userEvent.keyboard("]]");
  await userEvent.keyboard("[[");
  expect(line).toHaveValue("4");
  expect(await screen.findByText("It rose.")).toBeVisible();
  line.focus();
  await userEvent.keyboard("{ArrowRight}{PageUp}");
  expect(line).toHaveValue("15");
  await userEvent.keyboard("{End}");
  expect(line).toHaveValue("20");
});

it("asks for one moment at a time, and only for the last wish", async () => {
  const server = show();
  await screen.findByRole("slider", { name: "Moment of run.mcap" });
  const before = server.params("recording.state").length;
  await act(async () => {
    for (let at = 1; at <= 10; at++) goTo(at);
  });
  expect(server.params("recording.state").length - before).toBeLessThanOrEqual(2);
  expect(state().live?.health).toBe("at 10");
});

it("is not mixed with what runs", async () => {
  show();
  await screen.findByRole("slider", { name: "Moment of run.mcap" });
  act(() => listener.onNotification("live", { state: { ...STATE, health: "now" } }));
  expect(state().live?.health).not.toBe("now");
  render(<Live />);
  expect(screen.getByText(/shows the recording run.mcap/)).toBeVisible();
  await userEvent.selectOptions(screen.getByRole("combobox", { name: "Recording" }), "");
  expect(state().live).toBeNull();
  expect(player().read).toBeNull();
});

it("says why a file cannot be opened", async () => {
  const server = show([]);
  server.answer("recording.open", () => ({ share: 0, fault: "other.mcap is none", read: null }));
  const choice = await screen.findByRole("combobox", { name: "Recording" });
  await screen.findByRole("option", { name: "other.mcap" });
  await userEvent.selectOptions(choice, "other.mcap");
  expect(await screen.findByRole("alert")).toHaveTextContent("other.mcap is none");
});
