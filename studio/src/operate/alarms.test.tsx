import { act, fireEvent, render, screen } from "@testing-library/preact";
import userEvent from "@testing-library/user-event";
import { beforeEach, expect, test, vi } from "vitest";
import { Alarms, Requests } from "./Alarms";
import type { Alarm, HandoffRequest, UnitState } from "./protocol";
import { setCaller, useUnit } from "./unit";

const asked: [string, unknown][] = [];

beforeEach(() => {
  asked.length = 0;
  setCaller({
    call: async (method, params) => {
      asked.push([method, params]);
      return {};
    },
  });
  useUnit.setState({ page: 1, mayCommand: true });
});

const tell = (state: Partial<UnitState>) =>
  act(() => useUnit.setState({ state: { commander: { page: 1 }, ...state } as UnitState }));

const alarm = (number: number, cause: string, back = 0): Alarm => ({
  number,
  cause,
  back,
  time: number,
  subject: cause,
  text: `lost ${number}`,
});

const causes = () => screen.queryAllByRole("listitem").map((item) => item.textContent);
const silencing = (cause: string) => screen.getByRole("button", { name: `Silence ${cause}` });

test("times are local, as those of plots", async () => {
  vi.stubEnv("TZ", "Asia/Kolkata");
  await tell({ alarms: [alarm(1, "gps", 9)] });
  render(<Alarms />);
  vi.unstubAllEnvs();
  expect(causes()).toEqual([expect.stringMatching("05:30:01 lost 1.*back again 05:30:09")]);
});

test("alarms of one cause stand together, the newest cause first", async () => {
  await tell({ alarms: [alarm(3, "gps"), alarm(2, "base", 9), alarm(1, "gps")] });
  render(<Alarms />);
  expect(causes()).toEqual([
    expect.stringMatching("gps.*lost 3.*lost 1"),
    expect.stringMatching("base.*lost 2.*back again"),
  ]);
});

test("what is newer waits while a hand is there, also while a press takes the focus", async () => {
  await tell({ alarms: [alarm(1, "gps")] });
  render(<Alarms />);
  const user = userEvent.setup();
  await user.type(screen.getByPlaceholderText("reason"), "known");
  await tell({ alarms: [alarm(2, "base"), alarm(1, "gps")] });
  await user.pointer([{ target: silencing("gps") }, { keys: "[MouseLeft>]" }]);
  expect(screen.getByRole("heading").textContent).toBe("⚠ 2 alarms, 1 newer");
  expect(causes()).toHaveLength(1);
  await user.pointer({ keys: "[/MouseLeft]" });
  expect(asked).toEqual([["silence", { numbers: [1], reason: "known" }]]);
  await tell({ alarms: [alarm(2, "base")] });
  expect(silencing("gps")).toBeDisabled();
  expect(causes()).toHaveLength(1);
  await user.pointer({ target: document.body });
  expect(causes()).toEqual([expect.stringContaining("base")]);
});

test("a request that is taken back leaves the others in their places", async () => {
  const request = (number: number): HandoffRequest => ({
    component: "1.1.1",
    number,
    client: `2.1.${number}`,
    authority: 9,
    explanation: "",
  });
  await tell({ requests: [request(1), request(2)] });
  render(<Requests />);
  fireEvent.pointerEnter(screen.getByRole("region"));
  await tell({ requests: [request(2), request(3)] });
  const grants = screen.getAllByRole("button", { name: "Grant" });
  expect(grants).toHaveLength(2);
  expect(grants[0]).toBeDisabled();
  fireEvent.click(grants[1] as Element);
  expect(asked).toEqual([["decide", { component: "1.1.1", number: 2, decision: "grant" }]]);
});
