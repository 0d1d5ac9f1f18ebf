import type { Values } from "./protocol";

/** Where the components are. */
export function Plan(_: { values: Values[] }) {
  return null;
}
