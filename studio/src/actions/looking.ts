// Who else has the project open, and telling them where this page looks.

import type { PresentPage, Ref } from "../protocol";
import { type Studio, state, update, useStudio } from "../store";
import { ask } from "./asking";

const NAME_KEY = "jausml-name";

/** What the person wants to be called, empty for nothing. */
export const ownName = (): string => localStorage.getItem(NAME_KEY) ?? "";

export function callMe(name: string): void {
  localStorage.setItem(NAME_KEY, name.trim());
  tell(state());
}

/** Tells others where this page looks, now and whenever that changes; returns what ends it. */
export function followLook(): () => void {
  return useStudio.subscribe((now, before) => {
    const isNew = now.project?.page !== before.project?.page || now.link !== before.link;
    if (isNew || WHERE.some((each) => now[each] !== before[each])) tell(now);
  });
}

const WHERE = ["file", "view", "chosen"] as const;

function tell({ link, project, file, view, chosen }: Studio): void {
  if (link !== "open" || !project) return;
  ask("look", { name: ownName(), file, view, element: chosen }).then(
    ({ pages }) => update({ pages }),
    () => undefined, // the connection is lost, which is told elsewhere
  );
}

/** The pages that others have open. */
export function othersOf({ pages, project }: Studio): PresentPage[] {
  return pages.filter((each) => !each.here || each.id !== project?.page);
}

/** How to call somebody whose name only they know. */
export function calledOf({ name, here }: PresentPage): string {
  return name || (here ? "another tab" : "another studio");
}

/** Who else has chosen one of some elements, empty for nobody. */
export function choosers(studio: Studio, elements: (Ref | "")[]): string {
  if (studio.pages.length < 2) return "";
  return othersOf(studio)
    .filter((each) => each.element && each.file === studio.file && elements.includes(each.element))
    .map(calledOf)
    .join(", ");
}
