// What panels take of the page around them.

import { socketAddress, TOKEN_KEY } from "../../connection";
import { useStudio } from "../../store";

/** Revision of the files, which is ahead of that of the graph while this is made. */
export function useRevision(): number {
  return useStudio((studio) => studio.project?.revision ?? 0);
}

/** How to reach the language server of this page. */
export function languageSocket(): { connect: () => WebSocket; token: string } {
  const token = sessionStorage.getItem(TOKEN_KEY) ?? "";
  return { connect: () => new WebSocket(socketAddress(window.location, "/language")), token };
}
