// What the address of the page says: the file, the view, where one looks and what is chosen. A reload
// shows the same, and so does the address elsewhere. What was typed and is not taken yet is kept too.

import { type Draft, type Sight, state, update, useStudio } from "./store";

const DRAFTS_KEY = "jausml-drafts";
const TOLD = ["file", "view", "chosen", "sight"] as const;
const PAUSE_MS = 100;

/** The part of an address behind its `#`. */
export function addressOf(): string {
  const { file, view, chosen, sight } = state();
  const fields = { file, view, chosen, sight: sight?.join(" ") };
  const parts = Object.entries(fields).filter((entry): entry is [string, string] =>
    Boolean(entry[1]),
  );
  return new URLSearchParams(parts).toString();
}

function sightIn(text: string | null): Sight | null {
  const [x, y, zoom] = (text ?? "").split(" ").map(Number);
  if (x === undefined || y === undefined || !zoom) return null;
  return [x, y, zoom].every(Number.isFinite) ? [x, y, zoom] : null;
}

function draftsIn(text: string | null): Draft[] {
  try {
    const drafts: unknown = JSON.parse(text ?? "[]");
    return Array.isArray(drafts) ? (drafts as Draft[]) : [];
  } catch {
    return [];
  }
}

/** Takes over what an address says, and what was typed before the page was loaded again. */
export function takeAddress(hash: string, storage: Storage): void {
  const parameters = new URLSearchParams(hash.replace(/^#/, ""));
  update({
    file: parameters.get("file") ?? "",
    view: parameters.get("view") ?? "",
    chosen: parameters.get("chosen") ?? "",
    sight: sightIn(parameters.get("sight")),
    drafts: draftsIn(storage.getItem(DRAFTS_KEY)),
  });
}

/** Keeps the address and the drafts as the page is, and begins anew at one that somebody enters. */
export function keepAddress(window: Window, storage: Storage): void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  const tell = () => {
    timer = undefined;
    if (state().file) window.history.replaceState(null, "", `#${addressOf()}`);
  };
  useStudio.subscribe((now, before) => {
    if (now.drafts !== before.drafts) storage.setItem(DRAFTS_KEY, JSON.stringify(now.drafts));
    // Browsers take so many new addresses in a while, and no more.
    const isOther = TOLD.some((name) => now[name] !== before[name]);
    if (isOther && timer === undefined) timer = setTimeout(tell, PAUSE_MS);
  });
  window.addEventListener("pagehide", tell);
  window.addEventListener("hashchange", () => window.location.reload());
}
