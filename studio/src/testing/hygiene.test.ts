// What models say is text. Nothing on this page makes markup or code of it.

import { expect, it } from "vitest";

const SOURCES = import.meta.glob<string>("../**/*.{ts,tsx}", {
  query: "?raw",
  import: "default",
  eager: true,
});
const FORBIDDEN = new RegExp(
  [
    "dangerouslySet" + "InnerHTML",
    "inner" + "HTML",
    "outer" + "HTML",
    "insertAdjacent" + "HTML",
    "document\\.wr" + "ite",
    "createContextual" + "Fragment",
    "srcd" + "oc",
    "\\bev" + "al\\(",
    "new Func" + "tion\\(",
  ].join("|"),
);

it("takes model text into the page as text alone", () => {
  expect(Object.keys(SOURCES).length).toBeGreaterThan(20);
  const guilty = Object.entries(SOURCES).filter(([, text]) => FORBIDDEN.test(text));
  expect(guilty.map(([path]) => path)).toEqual([]);
});

it("asks nobody but its own server", () => {
  const addresses = Object.entries(SOURCES).flatMap(([path, text]) =>
    [...text.matchAll(/\b(?:https?|wss?):\/\/(?!\$\{)[^\s"'`]*/g)].map(
      (match) => `${path}: ${match[0]}`,
    ),
  );
  expect(
    addresses.filter((address) => !address.includes("127.0.0.1") && !address.includes("localhost")),
  ).toEqual([]);
});

it("asks nothing of preact that react alone does", () => {
  const foreign = new RegExp(["\\bauto" + "Focus\\b", "spell" + "Check=\\{"].join("|"));
  const asking = Object.entries(SOURCES).filter(([, text]) => foreign.test(text));
  expect(asking.map(([path]) => path)).toEqual([]);
});

it("calls variables by what they are", () => {
  const hiding = "(?:each|found|told|made|given|ways|stays)";
  const declared = new RegExp(`(?:\\b(?:const|let) |[([,] ?)${hiding}\\b(?=[^"\`\n]*=)`);
  const named = Object.entries(SOURCES).filter(([, text]) => declared.test(text));
  expect(named.map(([path]) => path)).toEqual([]);
});
