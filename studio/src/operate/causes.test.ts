import { expect, it } from "vitest";
import { causesOf } from "./Alarms";
import type { Alarm } from "./protocol";

const alarm = (number: number, cause: string, back = 0): Alarm => ({
  number,
  cause,
  back,
  time: number,
  subject: cause,
  text: "lost",
});

it("stands alarms of one cause together, the newest cause first", () => {
  const sounding = [alarm(3, "gps"), alarm(2, "base"), alarm(1, "gps")];
  const found = causesOf(sounding, sounding);
  expect(found.map(({ cause, alarms }) => [cause, alarms.map((each) => each.number)])).toEqual([
    ["gps", [3, 1]],
    ["base", [2]],
  ]);
});

it("keeps the order that a hand is at, and shows what has become of it", () => {
  const shown = [alarm(2, "base"), alarm(1, "gps")];
  const found = causesOf(shown, [alarm(3, "tool"), alarm(2, "base", 9)]);
  expect(found.map(({ cause, alarms }) => [cause, alarms[0]?.back])).toEqual([["base", 9]]);
});
