import type { PaletteItem } from "../../protocol";

const MOST = 6;
const KEY = "jausml-recent";

/** What was added last, by label: its commands hold for one revision, so they are asked for anew. */
export type Recent = Pick<PaletteItem, "id" | "label" | "group">;

/** Returns what was added lately, the last one first. */
export function recent(storage: Storage): Recent[] {
  try {
    const kept: unknown = JSON.parse(storage.getItem(KEY) ?? "[]");
    return Array.isArray(kept) ? kept.filter(isRecent).slice(0, MOST) : [];
  } catch {
    return [];
  }
}

function isRecent(value: unknown): value is Recent {
  const entry = value as Recent | null;
  return (
    typeof entry?.id === "string" &&
    typeof entry.label === "string" &&
    typeof entry.group === "string"
  );
}

/** Keeps what was added, and returns the new list. */
export function remember(storage: Storage, { id, label, group }: Recent): Recent[] {
  const kept = [{ id, label, group }, ...recent(storage).filter((entry) => entry.id !== id)].slice(
    0,
    MOST,
  );
  storage.setItem(KEY, JSON.stringify(kept));
  return kept;
}
