import { renderHook } from "@testing-library/preact";
import { expect, test } from "vitest";
import { BOXES_AT_ONCE, further, useFewAtOnce } from "./turns";

interface Part {
  id: string;
  hidden?: boolean;
}

const parts = (from: number, to: number): Part[] =>
  Array.from({ length: to - from }, (_, at) => ({ id: `${from + at}` }));

const seen = (shown: Part[]) => shown.filter((part) => !part.hidden).map(({ id }) => id);

function steps(shown: Part[], wanted: Part[]): Part[][] {
  const turns = [shown];
  while (turns.at(-1) !== wanted) turns.push(further(turns.at(-1)!, wanted));
  return turns;
}

test("few parts come and few go at once, until all is as it is wanted", () => {
  const [before, wanted] = [parts(0, 200), parts(150, 500)];
  const turns = steps(before, wanted);
  expect(turns.length).toBeGreaterThan(4);
  turns.slice(1).forEach((shown, at) => {
    const [old, now] = [seen(turns[at]!), seen(shown)];
    expect(now.filter((id) => !old.includes(id)).length).toBeLessThanOrEqual(BOXES_AT_ONCE);
    expect(old.filter((id) => !now.includes(id)).length).toBeLessThanOrEqual(BOXES_AT_ONCE);
  });
});

test("what goes was hidden in the picture before", () => {
  const turns = steps(parts(0, 200), parts(190, 200));
  turns.slice(1).forEach((shown, at) => {
    const left = new Set(shown.map(({ id }) => id));
    const gone = turns[at]!.filter(({ id }) => !left.has(id));
    expect(gone.every(({ hidden }) => hidden)).toBe(true);
  });
});

test("what stays is at once as it is wanted, and what comes back is no more hidden", () => {
  const before = parts(0, 3);
  const wanted = [{ id: "1", x: 5 }];
  const shown = further<Part>(before, wanted);
  expect(shown.find(({ id }) => id === "1")).toBe(wanted[0]);
  expect(seen(shown)).toEqual(["1"]);
  expect(seen(further(shown, before))).toEqual(["0", "1", "2"]);
});

test("a change of the same parts is shown as it is", () => {
  const wanted = parts(0, 500);
  expect(further(parts(0, 500), wanted)).toBe(wanted);
});

test("few come with one picture, however often what is wanted changes before it", async () => {
  const hook = renderHook(({ wanted }) => useFewAtOnce(wanted), {
    initialProps: { wanted: parts(0, 1) },
  });
  for (const end of [100, 200, 300]) hook.rerender({ wanted: parts(0, end) });
  expect(hook.result.current.length).toBeLessThanOrEqual(1 + BOXES_AT_ONCE);
  await expect.poll(() => hook.result.current.length).toBe(300);
});
